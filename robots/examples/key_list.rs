//! Prints the key list of `robots/README.md`: run after a change of the schema, paste between the markers.

fn main() {
    print!("{}", haltline_robots::key_list());
}
