//! The facts as text: a heading for each file, one line for each question.

use vivace_mesh::Loaded;

use super::facts::{Facts, GraphFacts, ShapeFacts, TetFacts, TriangleFacts};
use crate::commands::input::Refusal;
use crate::commands::output::{counted, field, short};

/// Everything about one file, with an empty line after it.
pub(super) fn block(name: &str, inspected: &Result<Loaded<Facts>, Refusal>) -> String {
    let mut lines = Lines(String::new());
    match inspected {
        Ok(Loaded { mesh, notes }) => {
            let kind = match mesh {
                Facts::TriangleMesh(_) => "triangle mesh",
                Facts::TetrahedralMesh(_) => "tetrahedral mesh",
                Facts::Graph { .. } => "graph of a matrix",
                Facts::SignedDistance(_) => "signed distance function",
            };
            lines.0 = format!("{name}: {kind}\n");
            match mesh {
                Facts::TriangleMesh(facts) => lines.triangles(facts),
                Facts::TetrahedralMesh(facts) => lines.tets(facts),
                Facts::Graph { graph } => lines.matrix(graph),
                Facts::SignedDistance(facts) => lines.shape(facts),
            }
            for note in notes {
                lines.add("note", note);
            }
        }
        Err(refusal) => {
            lines.0 = format!("{name}: REFUSED\n");
            if let Some(line) = refusal.line {
                lines.add("line", &line.to_string());
            }
            lines.add("reason", &refusal.reason);
        }
    }
    lines.0 + "\n"
}

struct Lines(String);

impl Lines {
    fn add(&mut self, label: &str, value: &str) {
        field(&mut self.0, label, value);
    }

    fn triangles(&mut self, facts: &TriangleFacts) {
        let size = [
            counted(facts.vertices, "vertex", "vertices"),
            counted(facts.triangles, "triangle", "triangles"),
            counted(facts.edges, "edge", "edges"),
            counted(facts.hinges, "hinge", "hinges"),
        ];
        self.add("size", &size.join(", "));
        self.add("extent", &extent(facts.bounds));
        self.add("parts", &parts(facts.components, facts.isolated_vertices));
        let (ends, joints) = (facts.boundary_edges, facts.nonmanifold_edges);
        let surface = [
            verdict(facts.closed, "closed", "open", &[counts(ends, "boundary edge", "boundary edges")]),
            verdict(
                facts.manifold,
                "manifold",
                "not manifold",
                &[
                    counts(joints, "edge of over two triangles", "edges of over two triangles"),
                    counts(facts.nonmanifold_vertices, "vertex between fans", "vertices between fans"),
                ],
            ),
            verdict(
                facts.oriented,
                "oriented",
                "not oriented",
                &[counts(facts.misoriented_edges, "edge", "edges")],
            ),
            format!("Euler characteristic {}", facts.euler_characteristic),
        ];
        self.add("surface", &surface.join(", "));
        let volume = facts.volume.map(|volume| format!(", volume {} m^3", short(volume)));
        self.add("area", &format!("{} m^2{}", short(facts.area), volume.unwrap_or_default()));
        let fault = facts.no_volume_boundary.as_ref().map(|fault| format!("bounds no volume: {fault}"));
        self.add("solid", fault.as_deref().unwrap_or("bounds a volume"));
        let angle = facts.smallest_angle.map(|angle| format!("smallest {angle:.1} deg"));
        self.add("angles", angle.as_deref().unwrap_or("none: no triangle has an area"));
        let degenerate: Vec<String> = [
            counts(
                facts.repeated_triangles,
                "triangle that names a vertex twice",
                "triangles that name a vertex twice",
            ),
            counts(facts.flat_triangles, "triangle without area", "triangles without area"),
            counts(facts.folded_edges, "edge folded onto itself", "edges folded onto themselves"),
        ]
        .into_iter()
        .flatten()
        .collect();
        self.add(
            "degenerate",
            &if degenerate.is_empty() { "none".to_owned() } else { degenerate.join(", ") },
        );
        self.add("edges", &degrees(&facts.edge_graph));
        self.add("and hinges", &degrees(&facts.hinge_graph));
    }

    fn tets(&mut self, facts: &TetFacts) {
        let size = [
            counted(facts.vertices, "vertex", "vertices"),
            counted(facts.tetrahedra, "tetrahedron", "tetrahedra"),
            counted(facts.edges, "edge", "edges"),
        ];
        self.add("size", &size.join(", "));
        self.add("extent", &extent(facts.bounds));
        self.add("parts", &parts(facts.components, facts.isolated_vertices));
        let boundary = [
            counted(facts.boundary_triangles, "triangle", "triangles"),
            verdict(
                facts.boundary_closed,
                "closed",
                "open",
                &[counts(facts.open_boundary_edges, "edge", "edges")],
            ),
            verdict(
                facts.boundary_manifold && facts.nonmanifold_faces == 0,
                "manifold",
                "not manifold",
                &[
                    counts(
                        facts.nonmanifold_faces,
                        "face of over two tetrahedra",
                        "faces of over two tetrahedra",
                    ),
                    counts(facts.nonmanifold_boundary_edges, "edge", "edges"),
                    counts(facts.nonmanifold_boundary_vertices, "vertex", "vertices"),
                ],
            ),
        ];
        self.add("boundary", &boundary.join(", "));
        let volumes = facts
            .volumes
            .map(|[least, most]| format!("; of a tetrahedron {} to {} m^3", short(least), short(most)));
        self.add("volume", &format!("{} m^3{}", short(facts.volume), volumes.unwrap_or_default()));
        if let Some([least, most]) = facts.dihedral_angles {
            self.add("angles", &format!("dihedral {least:.1} to {most:.1} deg"));
        }
        if let Some([least, mean]) = facts.quality {
            self.add("quality", &format!("smallest {least:.3}, mean {mean:.3} (1: regular tetrahedron)"));
        }
        self.add("graph", &degrees(&facts.graph));
    }

    fn matrix(&mut self, graph: &GraphFacts) {
        let size = [counted(graph.vertices, "vertex", "vertices"), counted(graph.edges, "edge", "edges")];
        self.add("size", &size.join(", "));
        self.add("parts", &parts(graph.components, graph.isolated_vertices));
        self.add("graph", &degrees(graph));
    }

    fn shape(&mut self, facts: &ShapeFacts) {
        self.add("box", &extent(facts.bounds));
        let pieces = match facts.pieces {
            0 => "nothing, so it is thin or its box is wide".to_owned(),
            1 => "one piece, as follows".to_owned(),
            n => format!("{n} pieces, the largest as follows"),
        };
        self.add("filled", &format!("with cells of {} m: {pieces}", short(facts.cell_size)));
        if let Some(filling) = &facts.filling {
            self.tets(filling);
        }
    }
}

fn extent([low, high]: [[f64; 3]; 2]) -> String {
    let sides = [0, 1, 2].map(|axis| short(high[axis] - low[axis]));
    let corner = low.map(short);
    format!("{} m from ({})", sides.join(" x "), corner.join(", "))
}

fn parts(components: usize, isolated: usize) -> String {
    let isolated = counts(isolated, "isolated vertex", "isolated vertices");
    let components = counted(components, "component", "components");
    isolated.map_or(components.clone(), |isolated| format!("{components} and {isolated}"))
}

fn degrees(graph: &GraphFacts) -> String {
    format!(
        "degree {} to {}, mean {:.2}, s.d. {:.2}, degeneracy {}",
        graph.min_degree, graph.max_degree, graph.mean_degree, graph.degree_deviation, graph.degeneracy
    )
}

/// The count in words, if there is anything to count.
fn counts(count: usize, one: &str, many: &str) -> Option<String> {
    (count > 0).then(|| counted(count, one, many))
}

/// A property, or its opposite and how much speaks for that.
fn verdict(holds: bool, yes: &str, no: &str, against: &[Option<String>]) -> String {
    let against: Vec<&str> = against.iter().flatten().map(String::as_str).collect();
    match (holds, against.is_empty()) {
        (true, _) => yes.to_owned(),
        (false, true) => no.to_owned(),
        (false, false) => format!("{no} ({})", against.join(", ")),
    }
}
