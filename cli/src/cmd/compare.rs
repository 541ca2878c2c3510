//! `compare`: tools, strategies, directions and leads of a job side by side, ranked, with the reason why each lost.

use crate::screen::progress::SCREEN;
use crate::screen::{cancel, output, render};
use osculate::failure::{Done, Failure, Outcome};
use osculate::figure::postures::{Arrays, Postures};
use osculate::figure::{Study, sheet};
use osculate::job::Job;
use osculate::part::{self, LoadedFace, Part};
use osculate::watch::Stage;
use osculate::work::choice::{self, Choice, Row};
use osculate::work::ideal::{self, Bound};
use osculate::work::program::WallS;
use osculate::work::verify::VerdictKeys;
use osculate_productivity::ideal::Feeding;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// Contenders that are verified beside the best.
const VERIFIED: usize = 3;

/// The answer.
#[derive(Debug, Serialize)]
struct Comparison {
    format: u32,
    area_mm2: f64,
    ideal: Bound,
    /// Fastest first.
    candidates: Vec<Row>,
    story: String,
    /// The verdict on the program of the best.
    verdict: VerdictKeys,
    /// Best postures over the faces, with `--out`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    fields: Vec<FaceFields>,
}

/// Best postures over a face.
#[derive(Debug, Serialize)]
struct FaceFields {
    face: String,
    /// Each tool of the job by itself.
    tools: Vec<ToolField>,
    /// The best of them at every node.
    #[serde(skip_serializing_if = "Option::is_none")]
    best: Option<BestField>,
}

#[derive(Debug, Serialize)]
struct ToolField {
    tool: String,
    picture: String,
    postures: Arrays,
}

#[derive(Debug, Serialize)]
struct BestField {
    picture: String,
    /// Share of the nodes at which each tool is the best.
    share_percent: Vec<f64>,
    postures: Arrays,
}

/// Runs the verb.
pub fn run(path: &Path, out: Option<&Path>, nodes: usize, json: bool) -> Outcome {
    if let Some(out) = out {
        output::folder(out)?;
    }
    let job = Job::load(path)?;
    choice::check(&job)?;
    let claimed = out.map(output::claim).transpose()?;
    let mut pictures = Vec::new();
    let stage = Stage::begin(&SCREEN, "import");
    let faces = part::of_job(&job)?;
    faces.part.to_plan(job.path())?;
    stage.end();
    let stage = Stage::begin(&SCREEN, "ideal");
    let ideal = ideal::of_job(&job, &faces)?;
    stage.end();
    let fields = match out {
        Some(_) => {
            let stage = Stage::begin(&SCREEN, "fields");
            let made = fields(&job, &faces, nodes, &mut pictures, &|f| stage.at(f))?;
            stage.end();
            made
        }
        None => Vec::new(),
    };
    let stage = Stage::begin(&SCREEN, "choose");
    let mut choice = Choice::screen(&job, &faces).map_err(|why| faces.warned(why))?;
    let settled = choice::settle(&mut choice, VERIFIED, &(), &mut WallS::default(), &|f| stage.at(f))
        .map_err(|why| faces.warned(why))?;
    stage.end();
    let area_mm2 = faces.faces.iter().map(part::area).sum();
    let candidates = choice.rows();
    let verdict = VerdictKeys::of(&settled.verified.verdict);
    let story = choice.story();
    let answer = Comparison { format: 1, area_mm2, ideal, candidates, story, verdict, fields };
    if let Some(out) = out {
        let text = serde_json::to_string(&answer).map_err(Failure::job)?;
        pictures.push(("compare.json".to_owned(), text));
        let files: Vec<_> = pictures.iter().map(|(name, text)| (name.as_str(), text.as_bytes())).collect();
        let whole = cancel::whole();
        output::set(out, &files)?;
        drop(whole);
    }
    drop(claimed);
    if json {
        render::json(&answer)?;
    } else {
        render::text(&format!(
            "\n{}\n{}\n  {}\n  ideal time, estimated {} min: {}\n{}\n",
            choice::text_table(&answer.candidates),
            settled.verified.verdict,
            answer.story,
            answer.ideal.words(),
            answer.ideal.assumes,
            described(&answer.fields, out)
        ))?;
    }
    Ok(if settled.verified.summary.within_tolerance { Done::Yes } else { Done::NotWithinTolerance })
}

/// Pictures by the names of their files.
type Pictures = Vec<(String, String)>;

/// The best postures of the job's tools over its faces, with a picture of each.
fn fields(
    job: &Job,
    faces: &Part,
    nodes: usize,
    pictures: &mut Pictures,
    progress: &dyn Fn(f64),
) -> Result<Vec<FaceFields>, Failure> {
    let jobs = job.each_tool();
    let steps = (faces.faces.len() * jobs.len()) as f64;
    let mut made = Vec::with_capacity(faces.faces.len());
    for (k, face) in faces.faces.iter().enumerate() {
        let at = |tool: usize| progress((k * jobs.len() + tool) as f64 / steps);
        made.push(of_face(job, &jobs, face, nodes, pictures, &at)?);
    }
    Ok(made)
}

fn of_face(
    job: &Job,
    jobs: &[Job],
    face: &LoadedFace,
    nodes: usize,
    pictures: &mut Pictures,
    at: &dyn Fn(usize),
) -> Result<FaceFields, Failure> {
    let refuse = |e: String| Failure::file(job.path(), format!("{}: {e}", face.id));
    let study = Study::to_paint(&face.surface, face.nurbs()).map_err(|e| refuse(e.to_string()))?;
    let scene = sheet::beside_bar(&study, None);
    let tolerance = job.tolerance();
    let mut draw = |picture: &str, postures: &Postures<'_>, tool: &str| {
        let page = postures.page(&study, &scene, &format!("{}, {tool}", face.id));
        pictures.push((picture.to_owned(), page));
    };
    let (mut all, mut tools) = (Vec::with_capacity(jobs.len()), Vec::with_capacity(jobs.len()));
    for (k, one) in jobs.iter().enumerate() {
        at(k);
        let cutter = one.cutter();
        let feeding = Feeding { cutter: &cutter, feed_mm_min: one.feed_mm_min() };
        let limits = osculate_productivity::ideal::limits(&feeding, &tolerance, ideal::tilts(job).0);
        let postures =
            Postures::of(&face.surface, &cutter, &limits, nodes).map_err(|e| refuse(e.to_string()))?;
        let (tool, picture) = (one.tool_words(), format!("postures-{}-tool-{}.svg", face.id, k + 1));
        draw(&picture, &postures, &tool);
        tools.push(ToolField { tool, picture, postures: postures.arrays() });
        all.push(postures);
    }
    let several = (all.len() > 1)
        .then(|| Postures::best_of(&all, jobs.iter().map(Job::tool_words).collect()))
        .flatten();
    let best = match several {
        Some(best) => {
            let picture = format!("postures-{}-best.svg", face.id);
            draw(&picture, &best, "the best tool at every place");
            let share_percent = best.shares_percent();
            Some(BestField { picture, share_percent, postures: best.arrays() })
        }
        None => None,
    };
    Ok(FaceFields { face: face.id.clone(), tools, best })
}

/// What was made of the fields, in words.
fn described(fields: &[FaceFields], out: Option<&Path>) -> String {
    let mut text = String::new();
    for face in fields {
        for (k, tool) in face.tools.iter().enumerate() {
            let share = face
                .best
                .as_ref()
                .map(|b| format!(", the best at {:.0} % of the places", b.share_percent[k]));
            let _ =
                writeln!(text, "  {}, tool {}: {}{}", face.face, k + 1, tool.tool, share.unwrap_or_default());
        }
    }
    if let Some(out) = out {
        let _ = writeln!(text, "  pictures and compare.json in {}", out.display());
    }
    text
}
