/* SPDX-License-Identifier: Apache-2.0 */
/* The library that missing_library does not find: it lies in another folder. */
#if defined(_WIN32)
__declspec(dllexport)
#endif
int in_a_library_that_is_gone(void);

int in_a_library_that_is_gone(void) { return 0; }
