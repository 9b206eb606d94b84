//! A robot file to fill in, and the key list of the README, both made from the schema.

use std::fmt::Write;

use crate::schema::{Key, Occurs, TABLES, Table};

/// A complete, commented robot file that parses as it is.
///
/// Every value is an example that its owner must replace; the comments say what it means
/// and what it must be. Tables that not every robot has are given as comments.
#[must_use]
pub fn template() -> String {
    let mut text = String::from(
        "# Robot file for Haltline. Replace every value by that of your robot and state its source\n\
         # in a comment: measured, data sheet, or assumed. An assumed value is an assumption of the\n\
         # certificate. Units are part of the keys: metres, seconds, degrees where the key says so.\n\
         # The body frame is x forward, y left, counter-clockwise positive, origin at the rotation\n\
         # centre. Where one value bounds an error, write the worst case, not the average.\n",
    );
    for table in TABLES {
        let optional = matches!(table.occurs, Occurs::OnceIfAckermann | Occurs::AnyNumber);
        write_table(&mut text, table, if optional { "# " } else { "" });
    }
    text
}

fn write_table(text: &mut String, table: &Table, prefix: &str) {
    // Writing to a String cannot fail.
    let _ = writeln!(text);
    for line in wrapped(table.doc, 94) {
        let _ = writeln!(text, "# {line}");
    }
    let _ = writeln!(text, "{prefix}{}", table.header());
    for key in table.keys {
        let about = format!(
            "{} ({})",
            key.doc.trim_end_matches('.'),
            key.kind.in_words()
        );
        for line in wrapped(&about, 94) {
            let _ = writeln!(text, "# {line}");
        }
        let _ = writeln!(text, "{prefix}{} = {}", key.name, key.example);
    }
}

/// The README's list of tables and keys, in Markdown.
///
/// A test holds `robots/README.md` against it.
#[must_use]
pub fn key_list() -> String {
    let mut text = String::new();
    for table in TABLES {
        let occurs = match table.occurs {
            Occurs::Once => "once",
            Occurs::OnceIfAckermann => "once, only if `kinematics = \"ackermann\"`",
            Occurs::AtLeastOnce => "once for each scanner, at most four",
            Occurs::AnyNumber => "any number below its `[[scanner]]`, at most four",
        };
        let _ = writeln!(
            text,
            "### `{}`\n\n{} ({occurs})\n",
            table.header(),
            table.doc
        );
        let _ = writeln!(text, "| key | value | meaning |\n|---|---|---|");
        for Key {
            name, kind, doc, ..
        } in table.keys
        {
            let _ = writeln!(text, "| `{name}` | {} | {doc} |", kind.in_words());
        }
        let _ = writeln!(text);
    }
    text
}

/// Words of `text` in lines of at most `width` characters.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
