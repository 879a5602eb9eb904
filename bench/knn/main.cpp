#include "bench/knn/task.hpp"

int main(int argc, char** argv) {
  return treeline::bench::run_program(treeline::bench::knn::KnnTask(), argc, argv);
}
