use osculate_geom::*; use osculate_surfaces::*; use std::time::Instant;
fn load(name:&str)->NurbsSurface{let t=std::fs::read_to_string(format!("/work/shared/data/kernel/{name}")).unwrap();let mut l=t.lines();
let n:Vec<usize>=l.next().unwrap().split_whitespace().map(|x|x.parse().unwrap()).collect();
let f=|s:&str|s.split_whitespace().map(|x|x.parse::<f64>().unwrap()).collect::<Vec<_>>();
let ku=f(l.next().unwrap());let kv=f(l.next().unwrap());let mut p=vec![];let mut w=vec![];for s in l{let v=f(s);if v.len()<4{continue}p.push(Point3::new(v[0],v[1],v[2]));w.push(v[3]);}
NurbsSurface::new([n[2],n[3]],[ku,kv],Net{count:[n[0],n[1]],points:p,weights:Some(w)}).unwrap()}
fn main(){for k in ["poly","rat"]{let s=load(&format!("surf_{k}.txt"));println!("{k} rational {}",s.is_rational());
let t0=Instant::now(); let _=closest(&s,&Point3::new(1.,2.,3.),None).unwrap(); println!("first query (index) {:?}",t0.elapsed());
let t=std::fs::read_to_string(format!("/work/shared/data/kernel/far_{k}.txt")).unwrap();
let q:Vec<Vec<f64>>=t.lines().skip(1).map(|l|l.split_whitespace().map(|x|x.parse().unwrap()).collect()).collect();
let (mut bad,mut worst,mut gap,mut uvo,mut res)=(0,0f64,0f64,0f64,0f64);let mut kinds=[0;4];
for v in &q{let p=Point3::new(v[0],v[1],v[2]);match closest(&s,&p,None){Ok(f)=>{let e=(f.distance_mm-v[3])/v[3];if e>1e-9{bad+=1;println!("{v:?} {f:?}")}worst=worst.max(e.abs());gap=gap.max(f.gap_mm);res=res.max(f.residual);uvo=uvo.max((f.uv.u-v[4]).abs().max((f.uv.v-v[5]).abs()));kinds[f.kind as usize]+=1;},Err(e)=>{bad+=1;println!("{v:?} {e}")}}}
println!("bad {bad} worst {worst:.2e} gap {gap:.1e} res {res:.1e} uv {uvo:.1e} kinds {kinds:?}");
let time=|name:&str,n:usize,f:&mut dyn FnMut()->f64|{let mut best=f64::MAX;let mut acc=0.;for _ in 0..7{let t=Instant::now();acc+=f();best=best.min(t.elapsed().as_secs_f64());}println!("{name}: {:.1} ns ({acc:.3})",best/n as f64*1e9);};
let pts:Vec<Point3>=q.iter().map(|v|Point3::new(v[0],v[1],v[2])).collect();
time("global far",pts.len(),&mut||pts.iter().map(|p|closest(&s,p,None).unwrap().distance_mm).sum());
let mut x=12345u64;let mut r=||{x=x.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);(x>>11) as f64/(1u64<<53) as f64};
let uvs:Vec<Uv>=(0..2000).map(|_|uv(r(),r())).collect();
time("jet2",uvs.len(),&mut||uvs.iter().map(|p|{let j=s.jet2(*p);j.point.x+j.dvv.z+j.duv.x+j.duu.y}).sum());
let d:&dyn Surface=&s;
time("jet2 dyn",uvs.len(),&mut||uvs.iter().map(|p|{let j=d.jet2(*p);j.point.x+j.dvv.z+j.duv.x+j.duu.y}).sum());
time("point",uvs.len(),&mut||uvs.iter().map(|p|{let j=s.point(*p);j.x+j.y+j.z}).sum());
time("jet2+principal",uvs.len(),&mut||uvs.iter().map(|p|{let j=s.jet2(*p).forms().unwrap().principal();j.k_max}).sum());
let near:Vec<(Point3,Uv)>=uvs.iter().map(|p|{let j=s.jet2(*p);let n=j.normal().unwrap();(j.point+n.into_inner()*3.0,uv(p.u+0.003,p.v-0.002))}).collect();
time("hint",near.len(),&mut||near.iter().map(|(p,h)|closest(&s,p,Some(*h)).unwrap().distance_mm).sum());
time("global near",near.len(),&mut||near.iter().map(|(p,_)|closest(&s,p,None).unwrap().distance_mm).sum());
}}
