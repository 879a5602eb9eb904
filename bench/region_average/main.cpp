#include "bench/region_average/task.hpp"

int main(int argc, char** argv) {
  return treeline::bench::run_program(treeline::bench::region_average::RegionAverageTask(), argc, argv);
}
