#include "bench/closest_point/task.hpp"

int main(int argc, char** argv) {
  const treeline::bench::closest_point::ClosestPointTask task;
  return treeline::bench::run_program(task, argc, argv);
}
