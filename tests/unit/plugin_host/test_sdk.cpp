// SPDX-License-Identifier: Apache-2.0
// The parts of the SDK that need no host.
#include "c3de/sdk/sdk.hpp"

#include "support/catch.h"

using namespace c3de::sdk;

namespace {

struct test_clock_v0 {
  std::uint32_t size, rev;
  c3de_status(C3DE_CALL *set)(c3de_object *self, double seconds);
  std::uint64_t(C3DE_CALL *ticks)(c3de_object *self);
  c3de_status(C3DE_CALL *fail)(c3de_object *self, std::uint32_t how);
};

}  // namespace

template <>
inline constexpr std::string_view c3de::sdk::kTableId<test_clock_v0>{"test.iface.clock/0"};

namespace {

int clocksAlive = 0;

struct Named {
  virtual ~Named() = default;
  virtual std::string name() const { return "named"; }
};

/// With a virtual base class in front, so that the object does not begin with the cell.
class Clock : public Named, public Object<Clock> {
 public:
  static std::array<Interface, 1> interfaces();
  Clock() { ++clocksAlive; }
  ~Clock() override { --clocksAlive; }
  void set(double seconds) {
    if (seconds < 0.0) throw Error(C3DE_E_ARG, "time is negative");
    ticks_ = static_cast<std::uint64_t>(seconds * 1000.0);
  }
  std::uint64_t ticks() const noexcept { return ticks_; }
  Result<void> fail(std::uint32_t how) {
    switch (how) {
      case 0: return {};
      case 1: return Failure{C3DE_E_STATE, "asked to fail"};
      case 2: throw std::bad_alloc();
      case 3: throw std::runtime_error("an ordinary exception");
      default: throw 42;
    }
  }

 private:
  std::uint64_t ticks_ = 0;
};

constexpr test_clock_v0 kClockTable{sizeof(test_clock_v0), 2, thunk<Clock, &Clock::set>, thunk<Clock, &Clock::ticks>,
                                    thunk<Clock, &Clock::fail>};

std::array<Interface, 1> Clock::interfaces() { return {interfaceOf(kClockTable)}; }

}  // namespace

TEST_CASE("an object lives as long as somebody counts it") {
  {
    const Ref<Clock> mine = make<Clock>();
    CHECK(clocksAlive == 1);
    const auto theirs = Ref<>::share(mine.abi());
    const Ref<> copy = theirs;
    CHECK(copy.get() == mine.abi());
    CHECK(Object<Clock>::from(copy.get())->name() == "named");
  }
  CHECK(clocksAlive == 0);
  Ref<Clock> moved = make<Clock>();
  const Ref<Clock> target = std::move(moved);
  CHECK_FALSE(moved);
  CHECK(target);
}

TEST_CASE("an object answers its interfaces, by revision, through the boundary") {
  const Ref<Clock> clock = make<Clock>();
  const auto theirs = Ref<>::share(clock.abi());
  const auto *table = theirs.query<test_clock_v0>(2);
  REQUIRE(table);
  CHECK(table->set(theirs.get(), 1.5) == C3DE_OK);
  CHECK(table->ticks(theirs.get()) == 1500);
  CHECK(theirs.query<test_clock_v0>(3) == nullptr);
  CHECK(theirs.query<c3de_simulator_v1>() == nullptr);
  CHECK(clock.abi()->vt->query(clock.abi(), str("x"), 1, nullptr) == C3DE_E_ARG);
}

TEST_CASE("a thunk turns results and exceptions into a status") {
  const Ref<Clock> clock = make<Clock>();
  c3de_object *object = clock.abi();
  CHECK(kClockTable.set(object, -1.0) == C3DE_E_ARG);
  CHECK(kClockTable.fail(object, 0) == C3DE_OK);
  CHECK(kClockTable.fail(object, 1) == C3DE_E_STATE);
  CHECK(kClockTable.fail(object, 2) == C3DE_E_NOMEM);
  CHECK(kClockTable.fail(object, 3) == C3DE_E_EXCEPTION);
  CHECK(kClockTable.fail(object, 4) == C3DE_E_EXCEPTION);
  // A failure must not appear as success.
  CHECK(guard([] { throw Error(C3DE_OK, "odd"); }) == C3DE_E_INTERNAL);
}

TEST_CASE("spans become views and come back") {
  const std::vector<Vec3> points{{1, 2, 3}, {4, 5, 6}};
  const c3de_view view = rows<double, 3>(points);
  CHECK(view.count == 2);
  CHECK(view.comps == 3);
  CHECK(view.dtype == C3DE_F64);
  const auto back = asRows<double, 3>(view, "points");
  REQUIRE(back);
  CHECK((*back)[1] == points[1].data());
  CHECK(readVec3(view, "points").value() == points);
  CHECK_THAT((asRows<float, 3>(view, "points").failure().message), Contains("points: dtype 2, expected 1"));
  CHECK_THAT((asRows<double, 9>(view, "points").failure().message), Contains("3 numbers per row, expected 9"));
  c3de_view bad = view;
  bad.stride = 16;
  CHECK_FALSE(readVec3(bad, "points"));
  bad = view;
  bad.data = nullptr;
  CHECK_FALSE(readVec3(bad, "points"));
  bad = view;
  bad.dtype = 0;
  CHECK_FALSE(readVec3(bad, "points"));
  const std::array<std::array<float, 4>, 1> colours{{{1, 2, 3, 4}}};
  CHECK(readVec3(rows<float, 3>(colours), "first three").value() == std::vector<Vec3>{{1, 2, 3}});
}

TEST_CASE("text is collected from a sink in parts") {
  TextSink sink;
  CHECK(put(sink.sink(), "one ") == C3DE_OK);
  CHECK(put(sink.sink(), "two") == C3DE_OK);
  CHECK(sink.take() == "one two");
  CHECK(put({nullptr, nullptr}, "lost") == C3DE_E_ARG);
}

TEST_CASE("a service that is absent answers and does not crash") {
  const Host nobody;
  CHECK_FALSE(Registry(nobody));
  CHECK(Registry(nobody).create("x").failure().status == C3DE_E_UNSUPPORTED);
  CHECK(Mesh(nobody).load("x", C3DE_UNIT_M).failure().status == C3DE_E_UNSUPPORTED);
  Log(nobody).info("into the void");
  std::vector<std::uint32_t> triangles;
  CHECK_FALSE(Collision(nobody).sphere({0}, {}, 1.0, triangles));
  CHECK(Time(nobody).nowNs() == 0);
  CHECK_FALSE(nobody.require<c3de_log_v1>());
  std::size_t sum = 0;
  Jobs(nobody).parallelFor(10, 3, [&](std::size_t begin, std::size_t end) { sum += end - begin; });
  CHECK(sum == 10);
}

TEST_CASE("declarations for constant tables say what they were given") {
  constexpr c3de_param_decl modulus =
      numberParam({.id = "e", .label = "E", .unit = "Pa"}, {.min = 0, .max = 1e9, .softMin = 1, .softMax = 1e6}, 5e3,
                  C3DE_PARAM_MIN_OPEN | C3DE_PARAM_LOG_SCALE);
  CHECK(text(modulus.unit) == "Pa");
  CHECK(modulus.type == C3DE_PARAM_F64);
  CHECK(modulus.fallback == 5e3);
  constexpr c3de_param_decl dt = autoParam({.id = "dt"}, {.min = 0, .max = 1});
  CHECK(text(dt.fallback_text) == "auto");
  CHECK((dt.flags & C3DE_PARAM_AUTO) != 0);
  const std::array values{numberValue("a", 1), boolValue("b", true)};
  CHECK(text(strided(values.data(), 1, 0).id) == "b");
  CHECK(text(strided(values.data(), 1, sizeof values[0]).id) == "b");
}

namespace {

class Sample {
 public:
  static constexpr PluginInfo info{.id = "test.sample", .version = "1"};
  explicit Sample(Host) {}
};

}  // namespace

TEST_CASE("a scene record names what differs in one line of text, whatever a damaged state holds") {
  SceneRecord here, saved;
  here.add("world: gravity", 9.81);
  saved.add("world: gravity", 1.62);
  CHECK(here.differencesFrom(here).empty());
  CHECK_THAT(here.differencesFrom(saved), Contains("world: gravity is 9.81, in the state 1.62"));
  saved.add("world: title", std::string_view("\x1b[2J\n"
                                             "a\x7f"));
  saved.add("world: note", std::string(299, 'x') + "äöü" + std::string(400, 'q'));
  const std::string text = here.differencesFrom(saved);
  CHECK(std::none_of(text.begin(), text.end(), [](char c) { return (c >= 0 && c < 0x20) || c == 0x7f; }));
  CHECK_THAT(text, Contains("?[2J?a?") && Contains("…") && !Contains("q"));
}

TEST_CASE("the entry of an SDK plugin declines a host of another ABI") {
  using Entry = detail::PluginEntry<Sample>;
  c3de_offer offer{};
  offer.size = sizeof offer;
  offer.abi_min = offer.abi_max = C3DE_ABI_MAJOR;
  c3de_answer answer{};
  answer.size = sizeof answer;
  REQUIRE(Entry::query(&offer, &answer) == C3DE_OK);
  CHECK(text(answer.plugin->id) == "test.sample");
  CHECK(answer.plugin->needs_n == 0);
  offer.abi_min = offer.abi_max = C3DE_ABI_MAJOR + 1;
  CHECK(Entry::query(&offer, &answer) == C3DE_E_VERSION);
  CHECK(answer.plugin == nullptr);
  CHECK_THAT(std::string(answer.why_not), Contains("built for ABI 1, the host offers 2 to 2"));
  CHECK(Entry::query(nullptr, &answer) == C3DE_E_ARG);
  answer.size = 4;
  CHECK(Entry::query(&offer, &answer) == C3DE_E_ARG);
}
