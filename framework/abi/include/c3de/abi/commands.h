/* SPDX-License-Identifier: Apache-2.0 */
/* Commands: what a person starts by an entry of the menu Plugins or by keys. */
#ifndef C3DE_ABI_COMMANDS_H
#define C3DE_ABI_COMMANDS_H

#include "base.h"
#include "tools.h"

#define C3DE_COMMANDS_ID "c3de.commands/1"

/* add() was done without the shortcut, which another command has. */
#define C3DE_S_NO_SHORTCUT ((c3de_status)2)

typedef struct c3de_command { /* copied, strings included */
  uint32_t size;
  uint32_t rev;
  c3de_str id;        /* for example "org.example.measure" */
  c3de_str title;     /* the entry of the menu: "Measure volumes" */
  c3de_str doc;       /* one sentence, its tooltip; may be empty */
  uint32_t key;       /* ASCII upper case letter or digit; 0: none */
  uint32_t modifiers; /* C3DE_MOD_*; a command with a key has C3DE_MOD_CTRL or C3DE_MOD_ALT: keys alone are for tools */
  void *self;
  /* An error is shown to the person with its text. [main] */
  c3de_status(C3DE_CALL *run)(void *self);
} c3de_command;

typedef struct c3de_commands_v1 {
  uint32_t size;
  uint32_t rev;
  void *ctx;
  /* C3DE_S_NO_SHORTCUT: the keys are those of the program or of another plugin; the log names both. C3DE_E_EXISTS: the
   * id is taken. [main] */
  c3de_status(C3DE_CALL *add)(void *ctx, const c3de_command *command, c3de_handle *out);
  c3de_status(C3DE_CALL *remove)(void *ctx, c3de_handle command);                        /* [main] */
  c3de_status(C3DE_CALL *set_enabled)(void *ctx, c3de_handle command, uint32_t enabled); /* grey or not [main] */
  /* Carries out a command of any plugin; gives what its run gave. C3DE_E_NOT_FOUND names the nearest id; C3DE_E_STATE:
   * it is not enabled, or is running. [main] */
  c3de_status(C3DE_CALL *run)(void *ctx, c3de_str id);
} c3de_commands_v1;

#endif
