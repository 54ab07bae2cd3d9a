//! A decimal number of a text.

use nom::branch::alt;
use nom::character::complete::{char, digit0, digit1, one_of};
use nom::combinator::{all_consuming, opt, recognize};
use nom::{IResult, Parser};

/// A number, its text and the byte where it begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Number<'a> {
    pub value: f64,
    pub text: &'a str,
    pub offset: usize,
}

/// `-12`, `.5`, `3.`, `1.4E+0010`; neither `nan`, `inf` nor a Fortran `D` exponent.
pub(crate) fn is_decimal(text: &str) -> bool {
    all_consuming(decimal).parse(text).is_ok()
}

fn decimal(input: &str) -> IResult<&str, &str> {
    let whole = recognize((digit1, opt((char('.'), digit0))));
    let fraction = recognize((char('.'), digit1));
    let exponent = (one_of("eE"), opt(one_of("+-")), digit1);
    recognize((opt(one_of("+-")), alt((whole, fraction)), opt(exponent))).parse(input)
}

/// What they are, without their places.
pub(crate) fn values(list: &[Number<'_>]) -> Vec<f64> {
    list.iter().map(|n| n.value).collect()
}
