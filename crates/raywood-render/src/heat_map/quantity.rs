//! The registry of what heat maps show.

use raywood::Counts;

/// Defines the quantities: names, words for legends, descriptions, and what each is of a ray's counts.
macro_rules! quantities {
    ($($kind:ident, $name:literal, $label:literal, $description:literal, $of:expr;)*) => {
        /// What a heat map shows of a ray's way through a structure.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum HeatQuantity {
            $(#[doc = $description] $kind,)*
        }

        impl HeatQuantity {
            /// All quantities.
            pub const ALL: &[Self] = &[$(Self::$kind,)*];

            /// Its name, as command lines and tables have it.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$kind => $name,)*
                }
            }

            /// What is counted, in the words of a legend.
            pub fn label(self) -> &'static str {
                match self {
                    $(Self::$kind => $label,)*
                }
            }

            /// What it is, in one line.
            pub fn description(self) -> &'static str {
                match self {
                    $(Self::$kind => $description,)*
                }
            }

            /// This quantity of what a probe counted.
            pub fn of(self, counts: &Counts) -> u64 {
                let of: fn(&Counts) -> u64 = match self {
                    $(Self::$kind => $of,)*
                };
                of(counts)
            }
        }
    };
}

quantities! {
    Nodes, "nodes", "nodes entered per ray", "Nodes or cells that the ray enters.", |counts| counts.nodes;
    Boxes, "boxes", "box tests per ray", "Boxes tested against the ray.", |counts| counts.boxes;
    Primitives, "primitives", "primitive tests per ray", "Primitives tested against the ray.", |counts| counts.primitives;
    Tests, "tests", "box and primitive tests per ray", "Boxes and primitives tested against the ray.",
        |counts| counts.boxes + counts.primitives;
}

impl HeatQuantity {
    /// The quantity of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|quantity| quantity.name() == name)
    }
}
