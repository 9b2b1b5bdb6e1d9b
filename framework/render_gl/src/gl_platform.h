// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace c3de::render {

/// Notifies the OpenGL function loader that another context may have become current. Needed on Windows only.
void refreshGlFunctions();

}  // namespace c3de::render
