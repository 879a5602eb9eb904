#include "bench/inside/task.hpp"

int main(int argc, char** argv) {
  const treeline::bench::inside::InsideTask task;
  return treeline::bench::run_program(task, argc, argv);
}
