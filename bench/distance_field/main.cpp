#include "bench/distance_field/task.hpp"

int main(int argc, char** argv) {
  return treeline::bench::run_program(treeline::bench::distance_field::DistanceFieldTask(), argc, argv);
}
