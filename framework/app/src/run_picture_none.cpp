// SPDX-License-Identifier: Apache-2.0
#include "run_picture.h"

namespace c3de::app {

Expected<std::unique_ptr<RunPicture>> RunPicture::create() {
  return fail(ErrorCode::graphics,
              "--screenshot: this program was built without OpenGL (C3DE_BUILD_WINDOW=OFF) and draws no pictures");
}

}  // namespace c3de::app
