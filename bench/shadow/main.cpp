#include "bench/shadow/task.hpp"

int main(int argc, char** argv) {
  return treeline::bench::run_program(treeline::bench::shadow::ShadowTask(), argc, argv);
}
