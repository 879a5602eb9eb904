// Rows say everything, never NaN, and come back as they went.
#include <gtest/gtest.h>

#include <limits>

#include "bench/core/row.hpp"

namespace treeline::bench {
namespace {

const char* const fields[] = {"schema",       "task",         "block",         "dataset",      "n",
                              "seed",         "dataset_hash", "method",        "family",       "source",
                              "peer_version", "claim",        "build_knobs",   "query_knobs",  "query_set",
                              "queries",      "threads",      "status",        "reason",       "build_s",
                              "query_ns",     "query_ns_low", "query_ns_high", "query_cpu_ns", "samples",
                              "bytes",        "error",        "error_max",     "error_p99",    "error_mean",
                              "bias",         "error_floor",  "isa",           "flags",        "compiler",
                              "cpu",          "host",         "commit",        "time",         "input_bytes",
                              "advised"};

Row full_row() {
  Row r;
  r.task = "fake", r.block = "cube:10", r.dataset = "cube", r.n = 10, r.seed = 18446744073709551615ull;
  r.dataset_hash = format_hash(0xab);
  r.method = "kd", r.family = "kd", r.source = Source::peer, r.peer_version = "1.2", r.claim = Claim::bounded;
  r.build_knobs = {{"leaf", 8}, {"split", "sah"}}, r.query_knobs = {{"eps", 0.5}, {"exact", false}};
  r.query_set = "knn8", r.advised = true, r.queries = 7, r.threads = 2, r.status = Status::wrong,
  r.reason = "q 3";
  r.build_s = 0.5, r.query_ns = 100, r.query_ns_low = 90, r.query_ns_high = 120, r.query_cpu_ns = 99;
  r.samples = {90, 100, 120}, r.bytes = 4096, r.input_bytes = 1200;
  r.errors = {1e-3, 2e-3, 1.5e-3, 1e-4, -1e-5, 1e-9, false, "q 3", {{"fake_recall", 0.9}}};
  r.work_nodes = 3, r.work_primitives = 12.5;
  return r;
}

TEST(Rows, EveryFieldIsThereAndFlat) {
  for (const Row& row : {Row(), full_row()}) {
    const auto json = row.to_json();
    for (const char* field : fields) EXPECT_TRUE(json.contains(field)) << field;
    for (const auto& [name, value] : json.items())
      EXPECT_TRUE(value.is_primitive() || name == "build_knobs" || name == "query_knobs" || name == "samples")
          << name;
  }
}

TEST(Rows, WhatDoesNotApplyIsNull) {
  const auto json = Row().to_json();
  for (const char* field :
       {"peer_version", "reason", "build_s", "query_ns", "samples", "bytes", "input_bytes", "error", "bias"})
    EXPECT_TRUE(json[field].is_null()) << field;
}

TEST(Rows, NaNAndInfinityBecomeNull) {
  Row row;
  row.task = "fake";
  row.errors.error = std::numeric_limits<double>::quiet_NaN();
  row.query_ns = std::numeric_limits<double>::infinity();
  row.samples = {1.0, std::nan("")};
  row.errors.extra["fake_x"] = std::nan("");
  const auto json = nlohmann::ordered_json::parse(row.to_line());
  EXPECT_TRUE(json["error"].is_null() && json["query_ns"].is_null() && json["fake_x"].is_null());
  EXPECT_TRUE(json["samples"][1].is_null());
  EXPECT_EQ(row.to_line().find("nan"), std::string::npos);
}

TEST(Rows, ComeBackAsTheyWent) {
  const Row row = full_row();
  const Row back = Row::from_json(nlohmann::ordered_json::parse(row.to_line()));
  auto a = row.to_json(), b = back.to_json();
  a.erase("time"), b.erase("time");
  EXPECT_EQ(a, b);
  EXPECT_EQ(row.key(), back.key());
}

TEST(Rows, ReasonThatIsNoTextIsRepaired) {
  Row row;
  row.reason = "a library wrote \xff\xfe and\na newline";
  const std::string line = row.to_line();
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_TRUE(nlohmann::ordered_json::accept(line));
}

TEST(Rows, KeysTellCellsApartAndIgnoreResults) {
  const Row row = full_row();
  Row same = row;
  same.query_ns = 5, same.status = Status::ok, same.reason = "", same.bytes.reset();
  EXPECT_EQ(row.key(), same.key());
  const auto differs = [&](auto change) {
    Row other = row;
    change(other);
    return other.key() != row.key();
  };
  EXPECT_TRUE(differs([](Row& r) { r.build_knobs["leaf"] = 16; }));
  EXPECT_TRUE(differs([](Row& r) { r.query_knobs["eps"] = 0.25; }));
  EXPECT_TRUE(differs([](Row& r) { r.query_set = "knn1"; }));
  EXPECT_TRUE(differs([](Row& r) { r.queries = 8; }));  // as another profile has it
  EXPECT_TRUE(differs([](Row& r) { r.threads = 1; }));
  EXPECT_TRUE(differs([](Row& r) { r.seed = 1; }));
  EXPECT_TRUE(differs([](Row& r) { r.dataset_hash = format_hash(0xac); }));
}

TEST(Rows, StatusWordsAreTheEightOfTheFormat) {
  for (const char* word :
       {"ok", "wrong", "refused", "crashed", "timeout", "out_of_memory", "unsupported", "not_built"})
    EXPECT_EQ(to_string(status_from(word)), word);
  EXPECT_THROW(status_from("fine"), std::invalid_argument);
}

}  // namespace
}  // namespace treeline::bench
