//! Tokens: numbers of all dialects, brackets, ends.

use super::*;

fn all(text: &str) -> Vec<Token> {
    let mut lexer = Lexer::new(text.as_bytes(), 0);
    let mut out = Vec::new();
    while let Ok(t) = lexer.next() {
        out.push(t);
    }
    out
}

#[test]
fn numbers_of_all_dialects() {
    assert_eq!(
        all("1 -2 1. 1.E-3 1.5D+02 1E0 -.5 +7 +1.E5 .25 1e5"),
        [
            Token::Int(1),
            Token::Int(-2),
            Token::Real(1.0),
            Token::Real(1e-3),
            Token::Real(150.0),
            Token::Real(1.0),
            Token::Real(-0.5),
            Token::Int(7),
            Token::Real(1e5),
            Token::Real(0.25),
            Token::Real(1e5),
        ]
    );
    for bad in ["1.E999", "1.E", "1.2.3", "-"] {
        let text = format!("{bad} #3");
        let mut lexer = Lexer::new(text.as_bytes(), 0);
        assert_eq!(lexer.next(), Err(Stop::Bad(Mark::Number)), "{bad}");
        assert_eq!(lexer.next(), Ok(Token::Id(3)));
    }
}

#[test]
fn short_numbers_are_those_of_the_standard_library() {
    for text in
        ["0.1", "-3.14159265358979", "1.E22", "123456789012345.E-22", "-0.", "0.0001", "2.5E-3", "9E0"]
    {
        let expected: f64 = text.parse().unwrap();
        assert_eq!(short(text.as_bytes()).map(f64::to_bits), Some(expected.to_bits()), "{text}");
    }
    for long in ["1234567890123456.", "1.E23", "1.E-23", ".", "1.E"] {
        assert_eq!(short(long.as_bytes()), None, "{long}");
    }
}

#[test]
fn comments_enumerations_and_brackets() {
    let text = "/* ; ' */ .T. /**/$*\"0F\"<a#b>!MY";
    assert_eq!(
        all(text),
        [
            Token::Enum(Span { at: 11, len: 1 }),
            Token::Omitted,
            Token::Derived,
            Token::Binary,
            Token::Resource,
            Token::Word(Span { at: 29, len: 3 })
        ]
    );
}

#[test]
fn open_ends_are_told_from_ends() {
    for text in ["'abc", "/* x", "\"0F", ".UNSPEC"] {
        assert_eq!(Lexer::new(text.as_bytes(), 0).next(), Err(Stop::End { open: true }), "{text}");
    }
    assert_eq!(Lexer::new(b"  \t\x0c", 0).next(), Err(Stop::End { open: false }));
}

#[test]
fn a_statement_is_skipped_past_strings() {
    let mut lexer = Lexer::new(b"A('x;y') ? ; #4", 0);
    assert!(lexer.skip_statement());
    assert_eq!(lexer.next(), Ok(Token::Id(4)));
    assert!(!lexer.skip_statement());
}

#[test]
fn a_lost_apostrophe_costs_one_record() {
    let mut lexer = Lexer::new(b"'lost,1.);\n#5 = A('x');", 0);
    assert_eq!(lexer.next(), Err(Stop::Bad(Mark::OpenText)));
    assert_eq!((lexer.next(), lexer.next()), (Ok(Token::Semicolon), Ok(Token::Id(5))));
}
