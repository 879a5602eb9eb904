#include "bench/ray/task.hpp"

int main(int argc, char** argv) {
  const treeline::bench::ray::RayTask task;
  return treeline::bench::run_program(task, argc, argv);
}
