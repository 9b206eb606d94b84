//! The template and the README follow the schema.

use crate::schema::{Occurs, TABLES};
use crate::{Kinematics, Robot, key_list, template};

#[test]
fn the_template_parses() {
    let robot = Robot::parse(&template(), "template.toml").unwrap();
    assert_eq!(robot.values.scanners.len(), 1);
}

#[test]
fn the_contract_of_the_template_holds() {
    let robot = Robot::parse(&template(), "template.toml").unwrap();
    let contract = crate::contract::Contract::of(&robot);
    assert!(contract.holds(), "{:#?}", contract.checks);
}

#[test]
fn the_template_shows_every_table_and_key() {
    let text = template();
    for table in TABLES {
        assert!(text.contains(&table.header()));
        for key in table.keys {
            assert!(text.contains(&format!("{} = {}", key.name, key.example)));
        }
    }
}

/// The parts that are comments in the template are right as well.
#[test]
fn the_optional_tables_of_the_template_parse() {
    let mut text = template().replace("\"differential\"", "\"ackermann\"");
    for table in TABLES {
        if matches!(table.occurs, Occurs::OnceIfAckermann | Occurs::AnyNumber) {
            text = text.replace(&format!("# {}", table.header()), &table.header());
            for key in table.keys {
                let line = format!("{} = {}\n", key.name, key.example);
                text = text.replace(&format!("# {line}"), &line);
            }
        }
    }
    let robot = Robot::parse(&text, "template.toml").unwrap();
    assert!(matches!(robot.values.kinematics, Kinematics::Ackermann(_)));
    assert_eq!(robot.values.scanners[0].masks.len(), 1);
}

#[test]
fn the_readme_holds_the_key_list() {
    let readme = include_str!("../../README.md");
    let begin = "<!-- keys: made by `key_list()`, checked by a test -->\n";
    let listed = readme.split_once(begin).map(|(_, rest)| rest);
    let listed = listed.and_then(|rest| rest.split_once("<!-- end of keys -->"));
    let listed = listed.map(|(list, _)| list.trim());
    // To update: `cargo run -p haltline-robots --example key_list`, paste between the markers.
    assert_eq!(listed, Some(key_list().trim()));
}

#[test]
fn the_readme_names_every_check_of_the_contract() {
    let readme = include_str!("../../README.md");
    let robot = Robot::embedded("seekur_jr").unwrap();
    for check in crate::contract::Contract::of(&robot).checks {
        assert!(
            readme.contains(&format!("| `{}` |", check.id)),
            "{}",
            check.id
        );
    }
}

#[test]
fn the_readme_lists_every_shipped_file() {
    let readme = include_str!("../../README.md");
    for (name, _) in crate::EMBEDDED {
        assert!(readme.contains(&format!("| `{name}.toml` |")), "{name}");
    }
}
