#include "core_fake_task.hpp"

int main(int argc, char** argv) {
  return treeline::bench::run_program(treeline::bench::FakeTask(), argc, argv);
}
