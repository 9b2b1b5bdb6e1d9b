// SPDX-License-Identifier: Apache-2.0
#include "support/folders.h"

const char *testDataFolder() { return C3DE_TEST_DATA; }
const char *testResourcesFolder() { return C3DE_TEST_RESOURCES; }
const char *testOutputRoot() { return C3DE_TEST_OUTPUT; }
const char *testPluginFolder() { return C3DE_TEST_PLUGIN_DIR; }
const char *testExampleFolder() { return C3DE_TEST_EXAMPLE_DIR; }
