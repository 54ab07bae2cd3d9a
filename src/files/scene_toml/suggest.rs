//! The nearest known word to a misspelt one.

/// Edit distance in characters where an insertion, a deletion, a substitution and a swap of two neighbours
/// cost 1 each (optimal string alignment, the restricted form of Damerau, CACM 7(3), 1964).
pub fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().collect();
    let b: Vec<char> = b.chars().collect();
    let mut before_last = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let changed = usize::from(a[i - 1] != b[j - 1]);
            row[j] = (last[j] + 1).min(row[j - 1] + 1).min(last[j - 1] + changed);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before_last[j - 2] + 1);
            }
        }
        before_last = last;
        last = row;
    }
    last[b.len()]
}

/// The known word nearest to `word`, or `None` where no word is near enough to be what was meant.
///
/// Case is ignored. Near enough is: at most half of the longer word's characters differ, or one of the two is
/// a beginning of the other of at least two characters. Of equally near words the first listed wins.
pub fn nearest<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    // A longer word matches nothing here, and the distance costs the product of both lengths.
    const LONGEST_WORD: usize = 64;
    if word.len() > LONGEST_WORD {
        return None;
    }
    let word = word.to_lowercase();
    let mut best: Option<(usize, &'k str)> = None;
    for &candidate in known.iter().filter(|k| k.len() <= LONGEST_WORD) {
        let lower = candidate.to_lowercase();
        let distance = edit_distance(&word, &lower);
        let longer = word.chars().count().max(lower.chars().count());
        let shorter = word.chars().count().min(lower.chars().count());
        let begins = shorter >= 2 && (word.starts_with(&lower) || lower.starts_with(&word));
        if (2 * distance <= longer || begins) && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// `"a, b or c"`.
pub fn list(words: &[&str]) -> String {
    match words {
        [] => String::from("nothing"),
        [only] => (*only).to_string(),
        [head @ .., tail] => format!("{} or {tail}", head.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_counts_insertions_deletions_substitutions_and_swaps() {
        for (a, b, distance) in [
            ("", "", 0),
            ("", "abc", 3),
            ("kitten", "sitting", 3),
            ("aim", "iam", 1),
            ("positon", "position", 1),
            ("ca", "abc", 3), // 2 without the restriction: a swapped pair is not edited again
            ("größe", "grösse", 2),
        ] {
            assert_eq!(edit_distance(a, b), distance, "{a} {b}");
            assert_eq!(edit_distance(b, a), distance, "{b} {a}");
        }
    }

    #[test]
    fn nearest_is_found_and_strangers_are_not() {
        let known = ["position", "aim", "up", "flux_lm", "focal_length"];
        for (word, found) in [
            ("positon", Some("position")),
            ("pos", Some("position")),
            ("AIM", Some("aim")),
            ("flux", Some("flux_lm")),
            ("flux_klm", Some("flux_lm")),
            ("focallength", Some("focal_length")),
            ("zebra", None),
            ("", None),
        ] {
            assert_eq!(nearest(word, &known), found, "{word}");
        }
        assert_eq!(nearest(&"p".repeat(1 << 20), &known), None);
    }

    #[test]
    fn words_are_listed_with_or() {
        assert_eq!(list(&["a"]), "a");
        assert_eq!(list(&["a", "b"]), "a or b");
        assert_eq!(list(&["a", "b", "c"]), "a, b or c");
    }
}
