//! Finds the place of a key in the text of a scene from its dotted path.

use std::ops::Range;

use toml_edit::{Document, Item, TableLike, Value};

/// Place in the text to which a path leads.
pub(super) struct Place {
    /// Span of the last existing key of the path; empty at the start of the text if no key exists.
    pub key: Range<usize>,
    /// Span of the value of that key.
    pub value: Range<usize>,
    /// Number of leading segments of the path that exist.
    pub depth: usize,
}

/// A node of the document.
enum Node<'a> {
    Table(&'a dyn TableLike),
    Item(&'a Item),
    Value(&'a Value),
}

/// Number of the line that contains the byte at `offset`, counted from 1.
pub(super) fn line(text: &[u8], offset: usize) -> usize {
    1 + text[..offset.min(text.len())].iter().filter(|byte| **byte == b'\n').count()
}

/// Follows `segments` as far as they exist.
pub(super) fn locate(document: &Document<&str>, segments: &[&str]) -> Place {
    let mut place = Place { key: 0..0, value: 0..0, depth: 0 };
    let mut node = Node::Table(document.as_table());
    for segment in segments {
        let Some((key, value, next)) = descend(node, segment) else {
            break;
        };
        // A table without its own header, implied by dotted keys or deeper headers, has no span.
        let value = value.or(key.clone()).unwrap_or(place.value);
        place = Place { key: key.unwrap_or(value.clone()), value, depth: place.depth + 1 };
        node = next;
    }
    place
}

type Span = Option<Range<usize>>;

fn descend<'a>(node: Node<'a>, segment: &str) -> Option<(Span, Span, Node<'a>)> {
    let index = segment.parse::<usize>();
    match node {
        Node::Table(table) => {
            let (key, item) = table.get_key_value(segment)?;
            Some((key.span(), item.span(), Node::Item(item)))
        }
        Node::Item(Item::ArrayOfTables(tables)) => {
            let table = tables.get(index.ok()?)?;
            Some((table.span(), table.span(), Node::Table(table)))
        }
        Node::Item(Item::Table(table)) => descend(Node::Table(table), segment),
        Node::Item(Item::Value(value)) => descend(Node::Value(value), segment),
        Node::Item(Item::None) => None,
        Node::Value(Value::InlineTable(table)) => descend(Node::Table(table), segment),
        Node::Value(Value::Array(array)) => {
            let value = array.get(index.ok()?)?;
            Some((value.span(), value.span(), Node::Value(value)))
        }
        Node::Value(_) => None,
    }
}
