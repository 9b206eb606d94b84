//! What an episode showed.

/// What an episode showed.
#[derive(Clone, Debug, Default)]
pub struct Report {
    pub ticks: usize,
    /// Ticks whose motion the kernel accepted and that move the robot.
    pub accepted: usize,
    /// Accepted steps whose whole tube was sampled; [`super::episode::Episode::tube_every`].
    pub judged: usize,
    pub courses: usize,
    /// Bodies the claim excused (GUARD-19), summed over the accepted steps.
    pub excused: usize,
    /// Accepted steps with a motion that touches an excused body.
    pub excused_contacts: usize,
    /// Contacts of admissible motions with returned bodies.
    pub contacts: Vec<String>,
    /// Contacts of the plant itself while it moved.
    pub crashes: Vec<String>,
    /// Contacts of the plant with bodies that no beam had returned.
    pub unseen: usize,
    /// Broken limits and rules of single decisions.
    pub faults: Vec<String>,
    pub path_m: f64,
    pub slowed: usize,
    pub refused: usize,
    /// Ticks in which the kernel braked a robot that moved.
    pub braking: usize,
}

impl Report {
    pub fn add(&mut self, other: Self) {
        self.ticks += other.ticks;
        self.accepted += other.accepted;
        self.courses += other.courses;
        self.excused += other.excused;
        self.excused_contacts += other.excused_contacts;
        self.unseen += other.unseen;
        self.path_m += other.path_m;
        self.slowed += other.slowed;
        self.refused += other.refused;
        self.braking += other.braking;
        self.judged += other.judged;
        self.contacts.extend(other.contacts);
        self.crashes.extend(other.crashes);
        self.faults.extend(other.faults);
    }
}
