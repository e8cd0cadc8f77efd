//! From the dotted path of a key to its place in the text.

use std::ops::Range;

use toml_edit::{Document, Item, TableLike, Value};

/// Where a path leads.
pub(super) struct Place {
    /// Span of the last key on the path that exists; empty at the start of the text when none does.
    pub key: Range<usize>,
    /// Span of what it stands for.
    pub value: Range<usize>,
    /// How many segments of the path exist.
    pub depth: usize,
}

/// A step into the document.
enum Node<'a> {
    Table(&'a dyn TableLike),
    Item(&'a Item),
    Value(&'a Value),
}

/// The number of the line, from 1, that the byte at `offset` belongs to.
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
        // A table that only dotted keys or deeper headers imply has no span of its own.
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
