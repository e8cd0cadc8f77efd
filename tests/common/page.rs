//! Strict reading of HTML pages.

use scraper::{Html, Selector};

/// Checks that a page is self-contained and without errors, and that its figures and tables have names.
pub fn strictly(text: &str) -> Html {
    // The page loads nothing from elsewhere and runs nothing: the only address is the name of SVG.
    assert_eq!(text.matches("://").count(), text.matches("xmlns=\"http://www.w3.org/2000/svg\"").count());
    let page = Html::parse_document(text);
    assert!(page.errors.is_empty(), "{:?}", page.errors);
    for absent in ["script", "link", "img", "iframe", "[src]", "[href]", "[onclick]"] {
        assert_eq!(count(&page, absent), 0, "{absent}");
    }
    for (one, wanted) in [
        ("html[lang=en]", 1),
        ("meta[charset]", 1),
        ("meta[name=viewport]", 1),
        ("h1", 1),
        ("table > caption", count(&page, "table")),
        ("figure > figcaption", count(&page, "figure")),
        ("svg[role=img][aria-label]", 2 * count(&page, "figure")),
        ("tbody > tr > th[scope=row]:first-child", count(&page, "tbody > tr")),
        ("thead th[scope=col]", count(&page, "thead th")),
    ] {
        assert_eq!(count(&page, one), wanted, "{one}");
    }
    page
}

/// Texts of all elements that match a selector, with plain spaces.
pub fn select<'a>(page: &'a Html, selector: &str) -> impl Iterator<Item = String> + use<'a> {
    let selector = Selector::parse(selector).unwrap();
    let texts: Vec<String> = page.select(&selector).map(|element| element.text().collect::<String>()).collect();
    texts.into_iter().map(|text| text.replace('\u{a0}', " "))
}

/// Number of elements that match a selector.
pub fn count(page: &Html, selector: &str) -> usize {
    select(page, selector).count()
}

/// All text of the page, with plain spaces.
fn words_of(page: &Html) -> String {
    select(page, "body").collect()
}

/// Checks that all of these texts are on the page.
#[track_caller]
pub fn says(page: &Html, all: &[&str]) {
    let text = words_of(page);
    for words in all {
        assert!(text.contains(words), "{words:?} is not in\n{text}");
    }
}
