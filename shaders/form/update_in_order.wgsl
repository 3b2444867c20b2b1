// Calls `update` for each element of the list, one after another.

@compute @workgroup_size(1)
fn main() {
    let len = headers[run.list].len;
    for (var k = 0u; k < len; k++) {
        update(list[k]);
    }
}
