void run(uvec2 id) { out_to[id.x].value = ~out_to[id.x].value; }
