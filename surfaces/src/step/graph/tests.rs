//! Records: simple and complex, damaged, truncated, many.

use super::*;

fn read(text: &str) -> Graph<'_> {
    Graph::read(text.as_bytes(), 0)
}

const HEAD: &str = "FILE_DESCRIPTION();FILE_NAME();FILE_SCHEMA(('A','B'));";

#[test]
fn simple_and_complex_records() {
    let text =
        format!("{HEAD}DATA;#1=A('x',(1,2.),$,.T.,B(3.));#2=(c(#1)D((#1),#7));ENDSEC;END-ISO-10303-21;");
    let g = read(&text);
    let said: Vec<String> = g.diagnostics.iter().map(ToString::to_string).collect();
    assert_eq!(said, ["warning: #2, line 1: it refers to #7, which is not in the file"]);
    let a = g.get(1).unwrap().part("A").unwrap();
    assert_eq!(arg(&a, 1).list().iter().filter_map(|v| v.number()).sum::<f64>(), 3.0);
    assert_eq!((arg(&a, 1).list().len(), a.len(), a.skip(3).len()), (2, 5, 2));
    assert_eq!((arg(&a, 3).flag(), arg(&a, 4).number()), (Some(true), Some(3.0)));
    assert!(arg(&a, 2).is_nothing() && arg(&a, 9).is_nothing());
    let second = g.peek(2).unwrap();
    assert_eq!((second.kind().as_str(), second.references().collect::<Vec<_>>()), ("C+D", vec![1, 1, 7]));
    assert_eq!(g.schemas, ["A", "B"]);
    assert_eq!(g.unused().map(|r| r.id()).collect::<Vec<_>>(), [2]);
}

#[test]
fn damage_is_skipped_and_told() {
    let g = read("#1=A(1;#2=A(2);\n#2=A(3);#3=;#4=A((?));#5=A('x\n);\n#6=A(5);END-ISO-10303-21;");
    let ids: Vec<u64> = g.structure().map(|r| r.id()).collect();
    assert_eq!(ids, [2, 6]);
    assert_eq!(arg(&g.get(2).unwrap().part("A").unwrap(), 0).number(), Some(2.0));
    let said: Vec<String> = g.diagnostics.iter().map(ToString::to_string).collect();
    // Four bad records, one duplicate, three header entities missing.
    assert_eq!(said.len(), 8, "{said:#?}");
    assert!(said[0].contains("line 1: #1") && said[3].contains("line 2: #5"), "{said:#?}");
    assert!(said[4].contains("#2, line 1: defined 2 times"), "{said:#?}");
}

#[test]
fn truncation_keeps_what_is_complete() {
    let g = read("#1=A(1);#2=A('abc");
    assert_eq!(g.len(), 1);
    assert!(g.diagnostics[0].message.contains("truncated"));
}

#[test]
fn deep_nesting_is_refused() {
    let text = format!("#1=A({}1{});#2=A();END-ISO-10303-21;", "(".repeat(100_000), ")".repeat(100_000));
    let g = read(&text);
    assert!(g.get(1).is_none() && g.get(2).is_some());
    assert!(g.diagnostics[0].message.contains("nested"));
}

#[test]
fn huge_numbers_and_scopes() {
    let text = "#18446744073709551615=A(#9);#3=&SCOPE #9=B(1);ENDSCOPE/#9/C(#9);END-ISO-10303-21;";
    let g = read(text);
    assert!(g.get(u64::MAX).unwrap().is("A") && g.get(3).unwrap().is("C") && g.get(9).unwrap().is("B"));
    assert!(g.get(18_446_744_073_709_551).is_none());
}

#[test]
fn many_pieces_read_as_one() {
    let mut text = String::from(HEAD);
    for k in 1..20_000 {
        text.push_str(&format!("#{k}=POINT('it''s;{k}',({k}.,/* ; ' */0.5),\"0F\");\n"));
    }
    text.push_str("END-ISO-10303-21;trailing");
    let g = read(&text);
    assert_eq!(g.len(), 19_999);
    assert_eq!(g.line(g.peek(19_000).unwrap().at()), 19_000);
    let p = g.peek(19_998).unwrap().part("POINT").unwrap();
    assert_eq!(arg(&p, 0).text(), "it's;19998");
    assert!(g.diagnostics[0].message.contains("8 characters behind"), "{:?}", g.diagnostics);
}
