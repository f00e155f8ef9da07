// tf_plot DESCRIPTION DATA_FOLDER OUT.svg
#include "docs/plot/figure.h"

#include <cstdio>
#include <exception>
#include <fstream>

int main(int argc, char **argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: tf_plot DESCRIPTION DATA_FOLDER OUT.svg\n");
    return 2;
  }
  try {
    const std::string svg = tf::plot::toSvg(tf::plot::readFigure(argv[1], argv[2]));
    std::ofstream file(argv[3], std::ios::binary);
    file << svg;
    if (!file.flush()) {
      std::fprintf(stderr, "tf_plot: cannot write '%s'\n", argv[3]);
      return 1;
    }
  } catch (const std::exception &error) {
    std::fprintf(stderr, "tf_plot: %s\n", error.what());
    return 1;
  }
  return 0;
}
