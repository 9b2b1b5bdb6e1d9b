// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace c3de::session {}

/// The program: its commands and its window, built on sessions.
namespace c3de::app {
using namespace c3de::session;
}
