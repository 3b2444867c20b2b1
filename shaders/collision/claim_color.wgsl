// The coloring of contacts: particles learn who wants a color, and who has it. See claim_color.rs.

struct Params {
    key: u32,
    mask: u32,
    is_settled: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> contacts: array<Contact>;
@group(1) @binding(1) var<storage, read> drawn: array<u32>;
@group(1) @binding(2) var<storage, read_write> lowest: array<atomic<u32>>;

fn lower(i: u32) {
    var value = hash(i, params.key);
    let has_to_wait = value == TAKEN || value == FREE;
    if params.is_settled != 0u {
        value = TAKEN;
    } else if has_to_wait {
        return;
    }
    let contact = contacts[i];
    let color = drawn[i];
    for (var slot = 0u; slot < 4u; slot++) {
        if color != NO_COLOR && is_free(contact, slot) {
            lower_to(entry(contact.particles[slot], color, params.mask), value);
        }
    }
}
