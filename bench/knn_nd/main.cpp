#include "bench/knn_nd/task.hpp"

int main(int argc, char** argv) {
  return treeline::bench::run_program(treeline::bench::knn_nd::KnnNdTask(), argc, argv);
}
