/* SPDX-License-Identifier: Apache-2.0
 * libepoxy for static linking. Its tables of OpenGL functions, one per thread, are allocated in DllMain, which the
 * system calls for a library file only. A program has callbacks for thread-local storage instead, with the same
 * arguments. */
#define DllMain epoxy_thread_tables
#include "dispatch_wgl.c"

static void NTAPI on_thread(PVOID image, DWORD reason, PVOID reserved) {
  epoxy_thread_tables((HINSTANCE)image, reason, reserved);
}

__attribute__((used, section(".CRT$XLF"))) static const PIMAGE_TLS_CALLBACK epoxy_on_thread = on_thread;
