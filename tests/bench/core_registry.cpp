// A method that CMake lists and that does not register, or the other way round, is found at once.
#include "bench/core/registry.hpp"

#include <gtest/gtest.h>

namespace treeline::bench {
namespace {

struct Entry {
  MethodInfo info;
};
Entry named(const char* name) {
  Entry entry;
  entry.info.name = name;
  return entry;
}

TEST(Registry, OrdersAsListed) {
  Registry<Entry> registry;
  registry.add(named("b")), registry.add(named("a"));
  const auto ordered = registry.in_order_of("a,b");
  EXPECT_EQ(ordered[0].info.name, "a");
  EXPECT_EQ(ordered[1].info.name, "b");
}

TEST(Registry, DisagreementsThrow) {
  Registry<Entry> registry;
  registry.add(named("a")), registry.add(named("b"));
  EXPECT_THROW(registry.in_order_of("a,b,c"), std::logic_error);
  EXPECT_THROW(registry.in_order_of("a"), std::logic_error);
  registry.add(named("a"));
  EXPECT_THROW(registry.in_order_of("a,b"), std::logic_error);
}

TEST(Registry, NotBuiltNames) {
  using Pairs = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(parse_not_built("flann:FLANN,pcl:PCL"), (Pairs{{"flann", "FLANN"}, {"pcl", "PCL"}}));
  EXPECT_EQ(parse_not_built(""), Pairs{});
}

}  // namespace
}  // namespace treeline::bench
