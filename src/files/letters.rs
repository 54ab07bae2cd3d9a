//! Text in the letters that a format has.

use super::decode::windows_1252;

/// Text in printable ASCII: letters with marks by their base letters or their usual spelling, controls as
/// blanks, what has no spelling as `?`; and whether anything but a control was changed.
pub fn ascii(text: &str) -> (String, bool) {
    convert(text, |c| (' '..='~').contains(&c))
}

/// The same in the letters of Windows-1252.
pub fn western(text: &str) -> (Vec<u8>, bool) {
    let byte = |c: char| (0x20..=0xff).find(|&b| b != 0x7f && windows_1252(b) == c);
    let (text, changed) = convert(text, |c| byte(c).is_some());
    (text.chars().map(|c| byte(c).unwrap_or(b'?')).collect(), changed)
}

fn convert(text: &str, has: impl Fn(char) -> bool) -> (String, bool) {
    let (mut out, mut changed) = (String::with_capacity(text.len()), false);
    for c in text.chars() {
        if has(c) && !c.is_control() {
            out.push(c);
        } else if c.is_control() || c.is_whitespace() {
            out.push(' ');
        } else {
            changed = true;
            out.push_str(spelt(c));
        }
    }
    (out, changed)
}

/// A letter or sign as ASCII spells it.
fn spelt(c: char) -> &'static str {
    match c {
        'ä' | 'æ' => "ae",
        'ö' | 'ø' | 'œ' => "oe",
        'ü' => "ue",
        'Ä' | 'Æ' => "Ae",
        'Ö' | 'Ø' | 'Œ' => "Oe",
        'Ü' => "Ue",
        'ß' => "ss",
        'À'..='Å' | 'Ā' | 'Ă' | 'Ą' => "A",
        'à'..='å' | 'ā' | 'ă' | 'ą' => "a",
        'Ç' | 'Ć' | 'Č' => "C",
        'ç' | 'ć' | 'č' => "c",
        'Ď' | 'Đ' => "D",
        'ď' | 'đ' => "d",
        'È'..='Ë' | 'Ē' | 'Ę' | 'Ě' => "E",
        'è'..='ë' | 'ē' | 'ę' | 'ě' => "e",
        'Ğ' => "G",
        'ğ' => "g",
        'Ì'..='Ï' | 'Ī' | 'İ' => "I",
        'ì'..='ï' | 'ī' | 'ı' => "i",
        'Ł' => "L",
        'ł' => "l",
        'Ñ' | 'Ń' | 'Ň' => "N",
        'ñ' | 'ń' | 'ň' => "n",
        'Ò'..='Õ' | 'Ō' | 'Ő' => "O",
        'ò'..='õ' | 'ō' | 'ő' => "o",
        'Ř' => "R",
        'ř' => "r",
        'Ś' | 'Š' | 'Ş' => "S",
        'ś' | 'š' | 'ş' => "s",
        'Ť' | 'Ţ' => "T",
        'ť' | 'ţ' => "t",
        'Ù'..='Û' | 'Ū' | 'Ů' | 'Ű' => "U",
        'ù'..='û' | 'ū' | 'ů' | 'ű' => "u",
        'Ý' => "Y",
        'ý' | 'ÿ' => "y",
        'Ź' | 'Ż' | 'Ž' => "Z",
        'ź' | 'ż' | 'ž' => "z",
        '\u{b0}' | '\u{ba}' => "deg",
        '\u{b5}' | '\u{3bc}' => "u",
        '\u{b2}' => "2",
        '\u{b3}' => "3",
        '\u{d7}' => "x",
        '\u{b1}' => "+-",
        '\u{bc}' => "1/4",
        '\u{bd}' => "1/2",
        '\u{be}' => "3/4",
        '\u{2010}'..='\u{2015}' | '\u{2212}' => "-",
        '\u{2018}' | '\u{2019}' | '\u{201a}' | '\u{b4}' => "'",
        '\u{201c}'..='\u{201e}' | '\u{ab}' | '\u{bb}' => "\"",
        '\u{2026}' => "...",
        '\u{2126}' | '\u{3a9}' => "Ohm",
        '\u{20ac}' => "EUR",
        '\u{a3}' => "GBP",
        '\u{a9}' => "(c)",
        '\u{ae}' => "(R)",
        '\u{2122}' => "(TM)",
        '\u{b7}' | '\u{2022}' => "*",
        _ => "?",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_that_a_format_has_not_are_spelt() {
        for (text, plain, changed) in [
            ("Plain 12 \"x\"", "Plain 12 \"x\"", false),
            ("Straßenleuchte für 60°", "Strassenleuchte fuer 60deg", true),
            ("a\tb\u{1b}c\u{a0}d", "a b c d", false),
            ("Éclairage – 2½ m²", "Eclairage - 21/2 m2", true),
            ("照明", "??", true),
        ] {
            assert_eq!(ascii(text), (plain.to_owned(), changed));
        }
        assert_eq!(western("für 60° €"), (b"f\xfcr 60\xb0 \x80".to_vec(), false));
        assert_eq!(western("Łódź 照"), (b"L\xf3dz ?".to_vec(), true));
    }
}
