//! Reads tables against the schema; every refusal says where and what to write.

use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::{RobotError, Source};
use crate::schema::{self, Key, Kind, Occurs, TABLES, Table};
use crate::suggest::suggestion;

/// Where each table and value stands, for rules that compare several of them.
///
/// Paths look like `limits.speed_reverse_mps`, `scanner[0].beams`, `scanner[0].mask[1]`.
#[derive(Debug, Default)]
pub(crate) struct Places(BTreeMap<String, Range<usize>>);

impl Places {
    fn insert(&mut self, path: String, span: Range<usize>) {
        self.0.insert(path, span);
    }

    /// Place of a path; the start of the file if it is not there.
    pub(crate) fn of(&self, path: &str) -> Range<usize> {
        self.0.get(path).cloned().unwrap_or(0..0)
    }
}

/// One table of the file together with what the schema says about it.
pub(crate) struct TableReader<'a> {
    source: Source<'a>,
    schema: &'static Table,
    path: String,
    span: Range<usize>,
    entries: &'a DeTable<'a>,
}

/// Parses the text; syntax errors are reported in our own form.
pub(crate) fn document<'a>(source: Source<'a>) -> Result<Spanned<DeTable<'a>>, RobotError> {
    DeTable::parse(source.text).map_err(|error| {
        let span = error.span().unwrap_or(0..0);
        let message = error.message().lines().next().unwrap_or("").to_owned();
        source.error(
            &span,
            format!("this is not TOML: {message}"),
            "write each value as `key = value` below its `[table]`, as in `haltline new robot`",
        )
    })
}

/// Refuses top-level entries that are no tables of the format.
pub(crate) fn check_top_level(source: Source<'_>, root: &DeTable<'_>) -> Result<(), RobotError> {
    for (name, value) in root {
        let name_text: &str = name.get_ref();
        if schema::table(name_text).is_none() || name_text.contains('.') {
            let known: Vec<_> = TABLES.iter().map(|table| table.name).collect();
            let shown = match value.get_ref() {
                DeValue::Table(_) | DeValue::Array(_) => format!("unknown table `{name_text}`"),
                _ => format!("key `{name_text}` stands outside every table"),
            };
            return Err(source.error(&name.span(), shown, suggestion(name_text, &known)));
        }
    }
    Ok(())
}

/// Opens a table that must occur once.
pub(crate) fn table<'a>(
    source: Source<'a>,
    root: &'a DeTable<'a>,
    name: &'static str,
    places: &mut Places,
) -> Result<TableReader<'a>, RobotError> {
    let schema = known_table(source, name)?;
    let Some(value) = root.get(name) else {
        return Err(source.error(
            &(0..0),
            format!("table `[{name}]` is missing"),
            example(schema),
        ));
    };
    open(source, schema, name.to_owned(), value, places)
}

/// Opens every element of an array of tables; none if the key is absent.
pub(crate) fn tables<'a>(
    source: Source<'a>,
    parent: &'a DeTable<'a>,
    schema_name: &'static str,
    path: &str,
    places: &mut Places,
) -> Result<Vec<TableReader<'a>>, RobotError> {
    let schema = known_table(source, schema_name)?;
    let name = schema_name.rsplit('.').next().unwrap_or(schema_name);
    let Some(value) = parent.get(name) else {
        return Ok(Vec::new());
    };
    let DeValue::Array(elements) = value.get_ref() else {
        return Err(source.error(
            &value.span(),
            format!("`{name}` must be a list of tables"),
            format!("write the header `[[{schema_name}]]` with double brackets"),
        ));
    };
    let mut readers = Vec::new();
    for (index, element) in elements.iter().enumerate() {
        readers.push(open(
            source,
            schema,
            format!("{path}[{index}]"),
            element,
            places,
        )?);
    }
    Ok(readers)
}

fn known_table(source: Source<'_>, name: &str) -> Result<&'static Table, RobotError> {
    schema::table(name).ok_or_else(|| {
        source.error(
            &(0..0),
            format!("the format has no table `{name}`"),
            "report this as a bug",
        )
    })
}

fn open<'a>(
    source: Source<'a>,
    schema: &'static Table,
    path: String,
    value: &'a Spanned<DeValue<'a>>,
    places: &mut Places,
) -> Result<TableReader<'a>, RobotError> {
    let DeValue::Table(entries) = value.get_ref() else {
        return Err(source.error(
            &value.span(),
            format!("`{}` must be a table", schema.name),
            format!(
                "write the header `{}` and its keys below it",
                schema.header()
            ),
        ));
    };
    places.insert(path.clone(), value.span());
    let reader = TableReader {
        source,
        schema,
        path,
        span: value.span(),
        entries,
    };
    reader.check_unknown_keys()?;
    reader.note_places(places);
    Ok(reader)
}

impl<'a> TableReader<'a> {
    /// The raw entries, for tables inside this one.
    pub(crate) fn entries(&self) -> &'a DeTable<'a> {
        self.entries
    }

    fn note_places(&self, places: &mut Places) {
        for (name, value) in self.entries {
            places.insert(format!("{}.{}", self.path, name.get_ref()), value.span());
        }
    }

    fn check_unknown_keys(&self) -> Result<(), RobotError> {
        for (name, _) in self.entries {
            let name_text: &str = name.get_ref();
            let child = format!("{}.{name_text}", self.schema.name);
            if self.schema.key(name_text).is_some() || schema::table(&child).is_some() {
                continue;
            }
            let known: Vec<_> = self.schema.keys.iter().map(|key| key.name).collect();
            return Err(self.source.error(
                &name.span(),
                format!("unknown key `{name_text}` in `{}`", self.schema.header()),
                suggestion(name_text, &known),
            ));
        }
        Ok(())
    }

    fn value(&self, name: &str) -> Result<(&'static Key, &'a Spanned<DeValue<'a>>), RobotError> {
        let Some(key) = self.schema.key(name) else {
            let problem = format!(
                "the format has no key `{name}` in `{}`",
                self.schema.header()
            );
            return Err(self
                .source
                .error(&self.span, problem, "report this as a bug"));
        };
        self.entries.get(name).map_or_else(
            || {
                Err(self.source.error(
                    &self.span,
                    format!("`{}` lacks the key `{name}`", self.schema.header()),
                    format!("add a line like `{} = {}` ({})", name, key.example, key.doc),
                ))
            },
            |value| Ok((key, value)),
        )
    }

    fn refuse(&self, key: &Key, value: &Spanned<DeValue<'_>>) -> RobotError {
        let raw = self.source.text.get(value.span()).unwrap_or("this");
        let shown = raw.lines().next().unwrap_or(raw);
        self.source.error(
            &value.span(),
            format!("`{}` cannot be {shown}", key.name),
            format!(
                "write {}, for example `{} = {}`",
                key.kind.in_words(),
                key.name,
                key.example
            ),
        )
    }

    /// A number within the bounds of its key.
    pub(crate) fn number(&self, name: &str) -> Result<f64, RobotError> {
        let (key, value) = self.value(name)?;
        let number = match value.get_ref() {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
            _ => None,
        };
        // A NaN fails every comparison and is refused.
        let allowed = |x: f64| match key.kind {
            Kind::Positive(max) => x > 0.0 && x <= max,
            Kind::NonNegative(max) => (0.0..=max).contains(&x),
            Kind::Signed(max) => x.abs() <= max,
            _ => false,
        };
        number
            .filter(|&x| allowed(x))
            .ok_or_else(|| self.refuse(key, value))
    }

    /// A whole number within the bounds of its key.
    pub(crate) fn count(&self, name: &str) -> Result<u32, RobotError> {
        let (key, value) = self.value(name)?;
        let number = match value.get_ref() {
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
            _ => None,
        };
        let allowed =
            |x: u32| matches!(key.kind, Kind::Count(min, max) if (min..=max).contains(&x));
        number
            .filter(|&x| allowed(x))
            .ok_or_else(|| self.refuse(key, value))
    }

    /// `true` or `false`.
    pub(crate) fn flag(&self, name: &str) -> Result<bool, RobotError> {
        let (key, value) = self.value(name)?;
        value
            .get_ref()
            .as_bool()
            .ok_or_else(|| self.refuse(key, value))
    }

    /// A text that is not empty.
    pub(crate) fn text(&self, name: &str) -> Result<String, RobotError> {
        let (key, value) = self.value(name)?;
        let text = value.get_ref().as_str().map(str::trim).unwrap_or_default();
        if text.is_empty() {
            return Err(self.refuse(key, value));
        }
        Ok(text.to_owned())
    }

    /// One of the words of the key.
    pub(crate) fn choice(&self, name: &str) -> Result<&'static str, RobotError> {
        let (key, value) = self.value(name)?;
        let Kind::Choice(words) = key.kind else {
            return Err(self.refuse(key, value));
        };
        let word = value.get_ref().as_str();
        words
            .iter()
            .copied()
            .find(|known| word == Some(known))
            .ok_or_else(|| self.refuse(key, value))
    }
}

/// The table as it would look, for a missing one.
fn example(schema: &Table) -> String {
    let lines = schema
        .keys
        .iter()
        .map(|key| format!("{} = {}", key.name, key.example));
    let keys: Vec<_> = lines.collect();
    let kind = match schema.occurs {
        Occurs::Once | Occurs::OnceIfAckermann => "add the table",
        Occurs::AtLeastOnce | Occurs::AnyNumber => "add at least one table",
    };
    format!(
        "{kind} `{}` with lines like `{}`",
        schema.header(),
        keys.join("`, `")
    )
}

/// Example of a missing array of tables.
pub(crate) fn example_of(name: &str) -> String {
    schema::table(name).map_or_else(String::new, example)
}
