void run(uvec2 pixel) {
  out_word[pixel.y * frameWidth + pixel.x].value = VERSION;
}
