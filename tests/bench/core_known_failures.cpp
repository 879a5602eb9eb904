// test_known_failures CSV TASK=PROGRAM...: runs every task's hard cases and compares with
// tests/known_failures.csv (task,method,case,status,why). Fails on a failure that is not listed, on a listed
// one that no longer happens, and on any failure of ours, which cannot be listed. Prints the lines to add or
// to remove.
//
// A status may be several, as wrong|crashed, where it depends on the machine; ok among them allows a pass.
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/core/registry.hpp"
#include "bench/core/row.hpp"
#include "core_known_failures.hpp"
#include "datasets_gen/hard/hard_case.hpp"
#include "datasets_gen/hard/hard_insides.hpp"
#include "datasets_gen/hard/hard_light.hpp"
#include "datasets_gen/hard/hard_rows.hpp"
#include "datasets_gen/hard/hard_surfaces.hpp"
#include "datasets_gen/hard/hard_textures.hpp"

namespace treeline::bench {
namespace {

#ifdef TREELINE_SANITIZED
constexpr bool hold_peers = false;  // sanitizers turn their wrong answers into crashes
#else
constexpr bool hold_peers = true;
#endif

std::string text_of(const std::string& file) {
  std::ostringstream out;
  out << std::ifstream(file).rdbuf();
  return out.str();
}

std::vector<Row> stress_rows(const std::string& program, const std::string& file) {
  const std::string command =
      "'" + program + "' --stress --rows '" + file + "' >/dev/null 2>'" + file + ".err'";
  const int status = std::system(command.c_str());
  const std::string said = text_of(file + ".err");
  if (!WIFEXITED(status) || WEXITSTATUS(status) > 1 || said.find("cannot be opened") != std::string::npos) {
    std::cerr << said;
    throw std::runtime_error(program + " --stress did not work");
  }
  std::vector<Row> out;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    out.push_back(Row::from_json(nlohmann::ordered_json::parse(line)));
  return out;
}

std::set<std::string> cases_that_may_be_refused() {
  std::set<std::string> out;
  for (const datasets::HardCase& hard : datasets::hard_cases())
    if (hard.expect == datasets::Expect::answers_or_refuses) out.insert(hard.name);
  for (const datasets::HardRows& hard : datasets::hard_rows())
    if (hard.expect == datasets::Expect::answers_or_refuses) out.insert(hard.name);
  for (const datasets::HardInside& hard : datasets::hard_insides())
    if (hard.expect == datasets::Expect::answers_or_refuses) out.insert(hard.name);
  for (const datasets::HardTexture& hard : datasets::hard_textures())
    if (hard.expect == datasets::Expect::answers_or_refuses) out.insert(hard.name);
  for (const datasets::HardLight& hard : datasets::hard_lights())
    if (hard.expect == datasets::Expect::answers_or_refuses) out.insert(hard.name);
  for (const datasets::HardSurface& hard : datasets::hard_surfaces())
    if (hard.expect == datasets::Expect::answers_or_refuses) out.insert(hard.name);
  return out;
}

int run(int argc, char** argv) {
  if (argc < 3) throw std::invalid_argument("usage: test_known_failures CSV TASK=PROGRAM...");
  const KnownFailures known = read_known_failures(argv[1]);
  std::string pattern = (std::filesystem::temp_directory_path() / "treeline_known_XXXXXX").string();
  const std::filesystem::path folder = mkdtemp(pattern.data());
  std::vector<Row> rows;
  for (int i = 2; i < argc; ++i) {
    const auto parts = split_names(argv[i], '=');
    if (parts.size() != 2) throw std::invalid_argument(std::string("not TASK=PROGRAM: ") + argv[i]);
    for (Row& row : stress_rows(parts[1], folder / parts[0])) rows.push_back(std::move(row));
  }
  std::filesystem::remove_all(folder);
  const auto problems = compare(known, rows, cases_that_may_be_refused(), hold_peers);
  for (const std::string& problem : problems) std::cout << problem << "\n";
  std::cout << rows.size() << " rows, " << known.size() << " known failures, " << problems.size()
            << " problems\n";
  return problems.empty() ? 0 : 1;
}

}  // namespace
}  // namespace treeline::bench

int main(int argc, char** argv) {
  try {
    return treeline::bench::run(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return 2;
  }
}
