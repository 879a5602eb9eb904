#include "bench/light_transport/task.hpp"

int main(int argc, char** argv) {
  return treeline::bench::run_program(treeline::bench::light_transport::LightTransportTask(), argc, argv);
}
