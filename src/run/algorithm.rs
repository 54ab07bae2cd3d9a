//! The algorithms that can be compared: the paper's variants and what may be changed about them.

use crate::error::{Diagnostic, Kind, Result};
use crate::math::solve::Solver;
use crate::sample::method::{Rejection, Sampling};
use crate::sequence::Sequence;

/// The algorithm variants; the paper's names, cumulative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// Independent points and rejection.
    Mc,
    /// Sobol' points and rejection.
    Qmc,
    /// Sobol' points and inverse functions; every choice draws its own coordinate.
    QmcInverse,
    /// Inverse functions with renormalisation: discrete events share a coordinate. The default.
    QmcInverseReuse,
}

impl Variant {
    /// Every variant, in the paper's order.
    pub const ALL: [Self; 4] = [Self::Mc, Self::Qmc, Self::QmcInverse, Self::QmcInverseReuse];

    /// The name in commands and files.
    pub const fn name(self) -> &'static str {
        ["mc", "qmc", "qmc-inverse", "qmc-inverse-reuse"][self as usize]
    }

    /// The variant of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|v| v.name() == name)
    }

    /// Whether discrete events share a coordinate (METHOD 2).
    pub const fn reuses(self) -> bool {
        matches!(self, Self::QmcInverseReuse)
    }

    /// Whether tables are sampled by rejection.
    pub const fn rejects(self) -> bool {
        matches!(self, Self::Mc | Self::Qmc)
    }

    /// The sequence it runs on where none is named.
    pub const fn sequence(self) -> Sequence {
        match self {
            Self::Mc => Sequence::Independent,
            Self::Qmc | Self::QmcInverse | Self::QmcInverseReuse => Sequence::SobolOwen,
        }
    }
}

/// A variant with everything about it that can be chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Algorithm {
    /// The variant.
    pub variant: Variant,
    /// Point sequence.
    pub sequence: Sequence,
    /// How variants that reject do it; without effect on the others.
    pub rejection: Rejection,
    /// Solver of the cell equation; without effect on variants that reject.
    pub solver: Solver,
}

impl Default for Algorithm {
    /// The best unbiased one: everything of the method, with the fastest solver.
    fn default() -> Self {
        Self { solver: Solver::DEFAULT, ..Self::from(Variant::QmcInverseReuse) }
    }
}

impl From<Variant> for Algorithm {
    /// The paper's variant: on its sequence, with the secant method where it inverts, rejecting inside the
    /// cell where it rejects.
    fn from(variant: Variant) -> Self {
        Self { variant, sequence: variant.sequence(), rejection: Rejection::default(), solver: Solver::PAPER }
    }
}

impl Algorithm {
    /// What a variant's name with qualifiers says: `qmc`, `qmc:table`, `qmc:next-point`,
    /// `qmc-inverse:halton:newton`. Qualifiers are a sequence, a way of rejection and a solver, in any order.
    ///
    /// # Errors
    /// An unknown name, and a qualifier of rejection on a variant that rejects nothing.
    pub fn parse(text: &str) -> Result<Self> {
        let mut words = text.split(':');
        let name = words.next().unwrap_or_default();
        let unknown = |word: &str, known: Vec<&str>| {
            let found =
                if word == text { format!("variant {word}") } else { format!("variant {text}: {word}") };
            Diagnostic::new(Kind::Unknown, found, format!("one of: {}", known.join(", ")))
        };
        let mut algorithm = Self::from(
            Variant::from_name(name)
                .ok_or_else(|| unknown(name, Variant::ALL.iter().map(|v| v.name()).collect()))?,
        );
        let rejects = algorithm.variant.rejects();
        for word in words {
            let misplaced = |required: &str| {
                Err(Diagnostic::new(Kind::Range, format!("variant {text}: {word}"), required))
            };
            if let Some(rejection) = Rejection::ALL.into_iter().find(|r| r.name() == word) {
                if !rejects {
                    return misplaced("mc or qmc: this variant samples by inverse functions");
                }
                algorithm.rejection = rejection;
            } else if let Some(solver) = Solver::from_name(word) {
                if rejects {
                    return misplaced("qmc-inverse or qmc-inverse-reuse: this variant solves no equation");
                }
                algorithm.solver = solver;
            } else if let Some(sequence) = Sequence::from_name(word) {
                algorithm.sequence = sequence;
            } else {
                let known = Rejection::ALL.iter().map(|r| r.name());
                let known = known.chain(Solver::ALL.iter().map(|s| s.name()));
                return Err(unknown(word, known.chain(Sequence::ALL.iter().map(|s| s.name())).collect()));
            }
        }
        Ok(algorithm)
    }

    /// The name that [`Self::parse`] takes back: the variant, and what differs from its defaults.
    pub fn name(&self) -> String {
        let default = Self::from(self.variant);
        let mut name = self.variant.name().to_string();
        for (differs, word) in [
            (self.rejection != default.rejection, self.rejection.name()),
            (self.solver != default.solver, self.solver.name()),
            (self.sequence != default.sequence, self.sequence.name()),
        ] {
            if differs {
                name = name + ":" + word;
            }
        }
        name
    }

    /// What it does, in words: sequence, way of sampling, coordinates.
    pub fn description(&self) -> String {
        let sampling = match self.sampling() {
            Sampling::Inverse(solver) => format!("inverse functions ({})", solver.name()),
            Sampling::Rejection(rejection) => rejection.description().to_string(),
        };
        let coordinates = if self.variant.reuses() { "; events share a coordinate" } else { "" };
        format!("{}; {sampling}{coordinates}", self.sequence.name())
    }

    /// Whether rejection that goes on with the next point can be right, where there is one emitter only or
    /// more.
    ///
    /// # Errors
    /// Such a rejection on a sequence that ends after N points, and with several emitters: the next point
    /// chooses the emitter anew, so that they would come out by flux times chance of acceptance.
    pub fn check_skipping(&self, one_emitter: bool) -> Result<()> {
        let required = match (self.sampling().skips_points(), self.sequence.needs_number(), one_emitter) {
            (true, true, _) => {
                "a sequence that goes on beyond N points, for rejection that retries with the next one"
            }
            (true, false, false) => {
                "a scene with one emitter, for rejection that retries with the next point"
            }
            (true, false, true) | (false, ..) => return Ok(()),
        };
        Err(Diagnostic::new(Kind::Range, format!("variant {}", self.name()), required))
    }

    /// How tables are sampled.
    pub fn sampling(&self) -> Sampling {
        if self.variant.rejects() {
            Sampling::Rejection(self.rejection)
        } else {
            Sampling::Inverse(self.solver)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip() {
        for name in [
            "mc",
            "qmc",
            "qmc-inverse",
            "qmc-inverse-reuse",
            "qmc:table",
            "mc:next-point",
            "qmc:next-point:sobol",
            "qmc-inverse:quadratic-newton",
        ] {
            assert_eq!(Algorithm::parse(name).unwrap().name(), name);
        }
        assert_eq!(Algorithm::parse("qmc:cell:sobol-owen").unwrap().name(), "qmc");
        assert_eq!(Algorithm::parse("mc").unwrap().sequence, Sequence::Independent);
    }

    #[test]
    fn wrong_names_are_refused() {
        for (name, needle) in [
            ("qcm", "variant qcm"),
            ("", "variant "),
            ("qmc:haltom", "variant qmc:haltom: haltom"),
            ("qmc-inverse:table", "variant qmc-inverse:table: table"),
            ("mc:newton", "variant mc:newton: newton"),
        ] {
            assert!(Algorithm::parse(name).unwrap_err().found().starts_with(needle), "{name}");
        }
    }
}
