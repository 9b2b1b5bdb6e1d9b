// SPDX-License-Identifier: Apache-2.0
// A simulation of c3de/embed.h for the duration of a test.
#pragma once

#include <string>
#include <vector>

#include "c3de/embed.h"
#include "support/catch.h"

inline std::string lastError() { return c3de_embed_last_error(); }

/// Requires the status, and shows the text of the library otherwise.
#define REQUIRE_OK(call)                \
  do {                                  \
    const c3de_status status_ = (call); \
    INFO(lastError());                  \
    REQUIRE(status_ == C3DE_OK);        \
  } while (false)

inline c3de_status tryOpen(const std::string &file, const std::vector<const char *> &assign, c3de_sim &out,
                           const std::string &plugin = {}) {
  c3de_embed_options options{};
  options.size = sizeof options;
  options.file = file.c_str();
  options.assign = assign.data();
  options.assign_n = assign.size();
  options.threads = 1;
  const char *const plugins[]{plugin.c_str()};
  options.plugin_files = plugins;
  options.plugin_files_n = plugin.empty() ? 0 : 1;
  return c3de_embed_open(&options, &out);
}

class OpenSimulation {
 public:
  explicit OpenSimulation(const std::string &file, const std::vector<const char *> &assign = {},
                          const std::string &plugin = {}) {
    REQUIRE_OK(tryOpen(file, assign, sim_, plugin));
  }
  ~OpenSimulation() { (void)c3de_embed_close(sim_); }
  OpenSimulation(const OpenSimulation &) = delete;
  OpenSimulation &operator=(const OpenSimulation &) = delete;
  [[nodiscard]] c3de_sim get() const { return sim_; }

 private:
  c3de_sim sim_ = 0;
};

inline c3de_embed_status statusOf(c3de_sim sim) {
  c3de_embed_status status{};
  status.size = sizeof status;
  REQUIRE_OK(c3de_embed_get_status(sim, &status));
  return status;
}

inline std::uint64_t hashOf(c3de_sim sim) {
  std::uint64_t hash = 0;
  REQUIRE_OK(c3de_embed_state_hash(sim, &hash));
  return hash;
}

inline c3de_embed_array viewOf(c3de_sim sim, std::uint32_t on, const char *name) {
  c3de_embed_array view{};
  view.size = sizeof view;
  REQUIRE_OK(c3de_embed_view_field(sim, 0, on, name, &view));
  return view;
}
