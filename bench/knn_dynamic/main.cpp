#include "bench/knn_dynamic/task.hpp"

int main(int argc, char** argv) {
  return treeline::bench::run_program(treeline::bench::knn_dynamic::KnnDynamicTask(), argc, argv);
}
