//! Whether an HTML page is well formed, and whether it needs anything else.

/// Elements that are never closed.
const VOID: &[&str] = &["meta", "br", "hr", "img", "input", "link", "!DOCTYPE"];

/// Checks that every tag is closed in its turn, every attribute quoted, and that `<`, `&` and quotes stand only where they may.
///
/// # Errors
///
/// The first fault and what surrounds it.
pub fn check_well_formed(page: &str) -> Result<(), String> {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = page;
    while let Some(start) = rest.find('<') {
        check_text(&rest[..start])?;
        let end =
            tag_end(&rest[start..]).ok_or_else(|| near("a tag has no end", &rest[start..]))?;
        let tag = &rest[start + 1..start + end];
        rest = &rest[start + end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            if open.pop() != Some(name.trim()) {
                return Err(near("closes what was not opened last", tag));
            }
            continue;
        }
        let name = tag.split([' ', '\n', '/']).next().unwrap_or_default();
        check_attributes(&tag[name.len()..]).map_err(|fault| near(fault, tag))?;
        if tag.ends_with('/') || VOID.iter().any(|void| void.eq_ignore_ascii_case(name)) {
            continue;
        }
        open.push(name);
        if name == "style" {
            let end = rest.find("</style>").ok_or_else(|| near("a style has no end", rest))?;
            rest = &rest[end..];
        }
    }
    check_text(rest)?;
    open.pop().map_or(Ok(()), |name| Err(format!("<{name}> is never closed")))
}

/// Whether the page loads nothing: no scripts, pictures, fonts or style sheets but those that are in it.
pub fn is_self_contained(page: &str) -> bool {
    // Pictures may be in the page itself.
    let page = page.replace("src=\"data:", "");
    let loads = ["src=", "<script", "<link", "url(", "@import", "xlink:href", "<iframe", "<object"];
    !loads.iter().any(|what| page.contains(what))
}

/// Where the tag that the text begins with ends.
fn tag_end(text: &str) -> Option<usize> {
    let mut quoted = false;
    text.char_indices().find_map(|(place, letter)| {
        quoted ^= letter == '"';
        (letter == '>' && !quoted).then_some(place)
    })
}

fn check_attributes(mut attributes: &str) -> Result<(), &'static str> {
    attributes = attributes.trim_end_matches('/').trim();
    while !attributes.is_empty() {
        let name_end = attributes.find(['=', ' ']).unwrap_or(attributes.len());
        let name = &attributes[..name_end];
        if name.is_empty() || name.contains(['"', '\'', '<']) {
            return Err("an attribute has no proper name");
        }
        attributes = &attributes[name_end..];
        if let Some(value) = attributes.strip_prefix('=') {
            let value = value.strip_prefix('"').ok_or("an attribute is not quoted")?;
            let end = value.find('"').ok_or("an attribute is not quoted")?;
            if value[..end].contains('<') {
                return Err("an attribute has a bare <");
            }
            attributes = &value[end + 1..];
        }
        attributes = attributes.trim_start();
    }
    Ok(())
}

/// Text has no bare `>` from a broken tag, and every `&` begins a reference.
fn check_text(text: &str) -> Result<(), String> {
    if text.contains('>') {
        return Err(near("a bare >", text));
    }
    for (place, _) in text.match_indices('&') {
        let reference = text[place + 1..].split(';').next().unwrap_or_default();
        if reference.is_empty() || !reference.chars().all(|c| c.is_ascii_alphanumeric() || c == '#')
        {
            return Err(near("a bare &", &text[place..]));
        }
    }
    Ok(())
}

fn near(fault: &str, text: &str) -> String {
    format!("{fault}, near `{}`", text.chars().take(60).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_found() {
        let good = "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><style>a>b{}</style>\
            <p class=\"x\">1 &lt; 2 &amp; 3</p><line x=\"1>2\"/></html>";
        assert_eq!(check_well_formed(good), Ok(()));
        for bad in [
            "<p>",
            "</p>",
            "<p><b></p></b>",
            "<p class=x></p>",
            "<p",
            "a & b",
            "a > b",
            "<style>",
            "<p class=\"x></p>",
            "<p title=\"<b>\"></p>",
        ] {
            assert!(check_well_formed(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn what_is_loaded_is_seen() {
        assert!(is_self_contained("<p>src and href</p>"));
        assert!(!is_self_contained("<img src=\"x.png\">"));
        assert!(!is_self_contained("<style>@import \"x.css\"</style>"));
    }
}
