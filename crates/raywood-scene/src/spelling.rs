//! What somebody meant who mistyped a name.

/// The candidate that a mistyped name probably meant, if there is one: at most a third of its letters wrong,
/// upper or lower case. Names of more than 64 bytes are not guessed: that would take long, and nobody types them.
pub fn closest_name<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    const LONGEST: usize = 64;
    let name = name.to_lowercase();
    candidates
        .into_iter()
        .filter(|candidate| name.len().max(candidate.len()) <= LONGEST)
        .map(|candidate| (edit_distance(&name, &candidate.to_lowercase()), candidate))
        .filter(|&(distance, candidate)| 3 * distance <= candidate.len().max(3))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// How many letters must be changed, added or removed to get from one word to the other (Levenshtein 1966).
fn edit_distance(a: &str, b: &str) -> usize {
    // One row of the table at a time: row[j] is the distance between what was read of `a` and the first j letters
    // of `b`.
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &other) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(letter != other);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_misses_find_what_was_meant() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(closest_name("whited", ["hall", "whitted"]), Some("whitted"));
        assert_eq!(closest_name("Hal", ["hall", "whitted"]), Some("hall"));
        assert_eq!(closest_name("brasS_cap", ["WOOD", "BRASS_CAPS"]), Some("BRASS_CAPS"));
        assert_eq!(closest_name("teapot", ["hall", "whitted"]), None);
    }
}
