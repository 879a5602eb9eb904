#include "bench/brdf_integral/task.hpp"

int main(int argc, char** argv) {
  return treeline::bench::run_program(treeline::bench::brdf_integral::BrdfIntegralTask(), argc, argv);
}
