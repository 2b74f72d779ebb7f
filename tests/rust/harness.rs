#![allow(unused)]
use encoders::@module@::*;
use encoders::{Fault, Verdict};
use std::convert::TryInto;
use std::io::{BufRead, BufWriter, Write};

type Words<'a> = std::str::SplitWhitespace<'a>;

trait Frame: Sized {
    fn taken(variant: &Variant, wire: &str) -> Result<Self, Fault>;
    fn sent(&self, variant: &Variant) -> Result<String, Fault>;
    fn shown(&self, variant: &Variant) -> String;
    fn of(words: &mut Words) -> Self;
    fn placed(variant: &Variant) -> Result<String, Fault>;
}

fn number(words: &mut Words) -> i128 {
    words.next().unwrap().parse().unwrap()
}

fn word(text: &str) -> u64 {
    u64::from_str_radix(text, 16).unwrap()
}

fn bytes(text: &str) -> Vec<u8> {
    (1..text.len()).step_by(2).map(|at| u8::from_str_radix(&text[at..at + 2], 16).unwrap()).collect()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{:02X}", byte)).collect()
}

fn told(result: Result<String, Fault>) -> String {
    match result {
        Ok(text) => text,
        Err(Fault::Length) => "length".to_string(),
        Err(Fault::Crc) => "crc".to_string(),
        Err(Fault::Constant(field)) => format!("constant {}", field),
        Err(Fault::Range(field)) => format!("range {}", field),
        Err(Fault::Undecided(what)) => format!("undecided {}", what),
        Err(fault) => format!("{:?}", fault),
    }
}

fn decoded<T: Frame>(variant: &Variant, words: &mut Words) -> String {
    told(T::taken(variant, words.next().unwrap()).map(|value| {
        format!("ok {} = {}", value.shown(variant), told(value.sent(variant)))
    }))
}

fn encoded<T: Frame>(variant: &Variant, words: &mut Words) -> String {
    told(T::of(words).sent(variant))
}

fn parameters(variant: &Variant) -> String {
    let shown: Vec<String> = vec![@parameters@];
    shown.join(" ")
}
@types@
fn answer(variant: &mut Variant, words: &mut Words) -> String {
    match words.next().unwrap() {
        "v" => {
            @set@
            parameters(variant)
        }
        "d" => match words.next().unwrap() {
@decode@
            _ => panic!(),
        },
        "e" => match words.next().unwrap() {
@encode@
            _ => panic!(),
        },
        "s" => match words.next().unwrap() {
@dispatch@
            _ => panic!(),
        },
        "p" => match words.next().unwrap() {
@placed@
            _ => panic!(),
        },
        "h" => match words.next().unwrap() {
@held@
            _ => panic!(),
        },
        "c" => match words.next().unwrap() {
@crcs@
            _ => panic!(),
        },
        "o" => {
            let mut shown: Vec<String> = Vec::new();
            @codes@
            shown.join(";")
        }
        "f" => {
            let text = words.next().unwrap();
            [@found@].join(" ")
        }
        "x" => match words.next().unwrap() {
@read@
            _ => panic!(),
        },
        "r" => {
            let shown: Vec<String> = vec![@registers@];
            shown.join(";")
        }
        _ => panic!(),
    }
}

fn main() {
    let mut variant = (@first@::ORDER_CODES[0].1).0;
    let mut out = BufWriter::new(std::io::stdout());
    for line in std::io::stdin().lock().lines() {
        writeln!(out, "{}", answer(&mut variant, &mut line.unwrap().split_whitespace())).unwrap();
    }
}
