// The coloring of contacts: who keeps what it has drawn. See settle_color.rs.

struct Params {
    key: u32,
    mask: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> contacts: array<Contact>;
@group(1) @binding(1) var<storage, read> drawn: array<u32>;
@group(1) @binding(2) var<storage, read> entries: array<u32>;
@group(1) @binding(3) var<storage, read_write> colors: array<u32>;

fn select_element(i: u32) -> bool {
    let claim = hash(i, params.key);
    let color = drawn[i];
    if color == NO_COLOR || claim == TAKEN || claim == FREE {
        return false;
    }
    let contact = contacts[i];
    for (var slot = 0u; slot < 4u; slot++) {
        if is_free(contact, slot) && entries[entry(contact.particles[slot], color, params.mask)] != claim {
            return false;
        }
    }
    colors[i] = color;
    return true;
}
