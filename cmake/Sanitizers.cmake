# C3DE_SANITIZE=address;undefined or thread, for every own target (presets asan and tsan).
add_library(c3de_sanitizers INTERFACE)
if(C3DE_SANITIZE AND NOT MSVC)
  list(JOIN C3DE_SANITIZE "," _c3de_sanitize)
  # -g1: functions and lines, which is what reports name; variables would take a third of the compile time.
  target_compile_options(c3de_sanitizers INTERFACE -fsanitize=${_c3de_sanitize} -fno-omit-frame-pointer -g1)
  target_link_options(c3de_sanitizers INTERFACE -fsanitize=${_c3de_sanitize})
  # Instrumented code hides from GCC that Eigen's evaluators are set; the sanitizers themselves find what is not.
  target_compile_options(c3de_sanitizers INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
elseif(C3DE_SANITIZE AND MSVC)
  target_compile_options(c3de_sanitizers INTERFACE /fsanitize=address)
endif()
