shared uint words[SIDE * SIDE];

void run(uvec2 id) {
  words[gl_LocalInvocationIndex] = 1000u * id.y + id.x;
  barrier();
  if (all(lessThan(id, launchSize))) out_to[id.y * frameWidth + id.x].value = words[SIDE * SIDE - 1 - gl_LocalInvocationIndex];
}
