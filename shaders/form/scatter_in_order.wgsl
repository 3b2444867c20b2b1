// Calls `scatter` for some elements of the list, one after another, from place `run.value`. Few in a dispatch: devices stop what runs
// too long, and Mesa's software driver ends the loops of an invocation silently after 65,535 iterations.

const IN_ORDER = 4u;

@compute @workgroup_size(1)
fn main() {
    let end = min(run.value + IN_ORDER, n_elements());
    for (var k = run.value; k < end; k++) {
        scatter(element(k));
    }
}
