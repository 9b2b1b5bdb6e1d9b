// SPDX-License-Identifier: Apache-2.0
#include "c3de/registry/text_panel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "c3de/core/text.h"
#include "c3de/registry/number_text.h"

namespace c3de::registry {
namespace {

std::string textOf(c3de_str text) { return displayText(fromAbi(text), Lines::many); }

struct Action {
  enum class Kind { press, check, number, text };
  Kind kind = Kind::press;
  bool flag = false;
  double number = 0.0;
  std::string text;
};

std::string withUnit(const std::string &text, const std::string &unit) {
  return unit.empty() ? text : text + " " + unit;
}

}  // namespace

struct TextPanel::Impl {
  ParameterRegistry *parameters = nullptr;
  c3de_ui_v1 table{};
  std::map<std::string, Action> actions;
  std::vector<Widget> widgets;
  std::vector<std::string> problems;
  std::string output;
  bool isSameLine = false;

  static Impl &of(void *ctx) { return *static_cast<Impl *>(ctx); }

  void line(const std::string &text) {
    if (!output.empty()) output += isSameLine ? "  " : "\n";
    isSameLine = false;
    output += text;
  }

  void widget(std::string kind, std::string id, std::string label, std::string text, bool enabled = true) {
    widgets.push_back({std::move(kind), std::move(id), std::move(label), std::move(text), enabled});
  }

  /// The pending action of this widget, if it is one that the widget supports.
  std::optional<Action> take(const std::string &id, std::initializer_list<Action::Kind> understood) {
    const auto it = actions.find(id);
    if (it == actions.end()) return std::nullopt;
    Action action = std::move(it->second);
    actions.erase(it);
    for (const Action::Kind kind : understood)
      if (kind == action.kind) return action;
    problems.push_back(id + ": this widget cannot do that");
    return std::nullopt;
  }

  std::uint32_t button(std::string id, std::string label, bool enabled);
  std::uint32_t checkbox(std::string id, std::string label, std::uint32_t *value);
  std::uint32_t slider(std::string id, std::string label, std::string unit, double *value, double lo, double hi);
  std::uint32_t choice(std::string id, std::string label, std::uint32_t *index, const c3de_str *names, std::uint64_t n);
  std::uint32_t textField(const char *kind, std::string id, std::string label, char *buffer, std::uint64_t capacity);
  void params(Handle handle, const std::string &group);
  void parameter(Handle handle, const ParameterDecl &decl, const ParameterValue &value);
  void fillTable();
};

std::uint32_t TextPanel::Impl::button(std::string id, std::string label, bool enabled) {
  const auto action = take(id, {Action::Kind::press});
  line((enabled ? "[button: " : "[disabled button: ") + label + "] (" + id + ")");
  widget("button", id, std::move(label), {}, enabled);
  if (!action) return 0;
  if (enabled) return C3DE_UI_COMMITTED;
  problems.push_back(id + ": the button is disabled");
  return 0;
}

std::uint32_t TextPanel::Impl::checkbox(std::string id, std::string label, std::uint32_t *value) {
  if (!value) return 0;
  std::uint32_t result = 0;
  if (const auto action = take(id, {Action::Kind::press, Action::Kind::check})) {
    const std::uint32_t wanted = action->kind == Action::Kind::press ? (*value == 0) : action->flag;
    if (wanted != (*value != 0 ? 1u : 0u)) result = C3DE_UI_CHANGED | C3DE_UI_COMMITTED;
    *value = wanted;
  }
  line((*value ? "[x] " : "[ ] ") + label + " (" + id + ")");
  widget("checkbox", std::move(id), std::move(label), *value ? "1" : "0");
  return result;
}

std::uint32_t TextPanel::Impl::slider(std::string id, std::string label, std::string unit, double *value, double lo,
                                      double hi) {
  if (!value) return 0;
  std::uint32_t result = 0;
  if (const auto action = take(id, {Action::Kind::number})) {
    if (!std::isfinite(action->number) || action->number < lo || action->number > hi) {
      problems.push_back(id + ": " + formatNumber(action->number) +
                         " is not accepted; accepted: " + withUnit(formatNumber(lo) + " … " + formatNumber(hi), unit));
    } else {
      if (action->number != *value) result = C3DE_UI_CHANGED | C3DE_UI_COMMITTED;
      *value = action->number;
    }
  }
  const std::string text = withUnit(formatNumber(*value), unit);
  line(label + " = " + text + " (" + id + ")");
  widget("slider", std::move(id), std::move(label), text);
  return result;
}

std::uint32_t TextPanel::Impl::choice(std::string id, std::string label, std::uint32_t *index, const c3de_str *names,
                                      std::uint64_t n) {
  if (!index) return 0;
  std::uint32_t result = 0;
  if (const auto action = take(id, {Action::Kind::text})) {
    bool isKnown = false;
    for (std::uint64_t i = 0; names && i < n; ++i) {
      if (textOf(names[i]) != action->text) continue;
      isKnown = true;
      if (*index != i) result = C3DE_UI_CHANGED | C3DE_UI_COMMITTED;
      *index = static_cast<std::uint32_t>(i);
    }
    if (!isKnown) problems.push_back(id + ": there is no choice '" + action->text + "'");
  }
  const std::string text = names && *index < n ? textOf(names[*index]) : std::string();
  line(label + " = " + text + " (" + id + ")");
  widget("choice", std::move(id), std::move(label), text);
  return result;
}

std::uint32_t TextPanel::Impl::textField(const char *kind, std::string id, std::string label, char *buffer,
                                         std::uint64_t capacity) {
  if (!buffer || capacity == 0) return 0;
  std::uint32_t result = 0;
  if (const auto action = take(id, {Action::Kind::text})) {
    if (bufferText(buffer, capacity) != action->text) result = C3DE_UI_CHANGED | C3DE_UI_COMMITTED;
    if (!copyText(buffer, capacity, action->text)) problems.push_back(id + ": the text is too long and was cut");
  }
  const std::string text(bufferText(buffer, capacity));
  line(label + " = \"" + text + "\" (" + id + ")");
  widget(kind, std::move(id), std::move(label), text);
  return result;
}

void TextPanel::Impl::parameter(Handle handle, const ParameterDecl &decl, const ParameterValue &value) {
  using Kind = Action::Kind;
  ParameterValue shown = value;
  if (const auto action = take(decl.id, {Kind::press, Kind::check, Kind::number, Kind::text})) {
    ParameterValue wanted = value;
    wanted.id = decl.id;
    wanted.type = decl.type;
    if (action->kind == Kind::number) {
      wanted.num = action->number;
    } else if (action->kind == Kind::text) {
      wanted.type = decl.type == C3DE_PARAM_CHOICE ? C3DE_PARAM_CHOICE : C3DE_PARAM_TEXT;
      wanted.text = action->text;
    } else {
      wanted.num = action->kind == Kind::press ? (value.num == 0.0) : action->flag;
    }
    if (auto done = parameters->edit(handle, wanted); !done)
      problems.push_back(done.error().message);
    else
      shown = wanted;
  }
  const bool isAuto = (decl.flags & C3DE_PARAM_AUTO) && shown.type == C3DE_PARAM_TEXT;
  const std::string text = isAuto ? shown.text : withUnit(shown.display(), decl.unit);
  line(decl.label + " = " + text + " (" + decl.id + ")");
  if (decl.flags & C3DE_PARAM_NEEDS_RESET) output += " [applies on rebuild]";
  widget("parameter", decl.id, decl.label, text);
}

void TextPanel::Impl::params(Handle handle, const std::string &group) {
  const ParameterSet *set = parameters ? parameters->find(handle) : nullptr;
  if (!set) return;
  // Copies, because a listener may change or remove the set.
  const std::vector<ParameterDecl> decls = set->decls;
  std::string heading;
  for (std::size_t i = 0; i < decls.size(); ++i) {
    if (!group.empty() && decls[i].group != group) continue;
    if (group.empty() && decls[i].group != heading) {
      heading = decls[i].group;
      line("# " + heading);
    }
    set = parameters->find(handle);
    if (!set || set->values.size() != decls.size()) return;
    parameter(handle, decls[i], ParameterValue(set->values[i]));
  }
}

void TextPanel::Impl::fillTable() {
  table.size = sizeof table;
  table.rev = 4;
  table.ctx = this;
  table.heading = [](void *c, c3de_str t) { of(c).line("# " + textOf(t)); };
  table.text = [](void *c, c3de_str t) {
    of(c).line(textOf(t));
    of(c).widget("text", {}, {}, textOf(t));
  };
  table.separator = [](void *c) { of(c).line("---"); };
  table.same_line = [](void *c) { of(c).isSameLine = true; };
  table.button = [](void *c, c3de_str id, c3de_str label, std::uint32_t enabled) {
    return of(c).button(textOf(id), textOf(label), enabled != 0);
  };
  table.checkbox = [](void *c, c3de_str id, c3de_str label, std::uint32_t *value) {
    return of(c).checkbox(textOf(id), textOf(label), value);
  };
  table.slider = [](void *c, c3de_str id, c3de_str label, c3de_str unit, double *value, double lo, double hi) {
    return of(c).slider(textOf(id), textOf(label), textOf(unit), value, lo, hi);
  };
  table.choice = [](void *c, c3de_str id, c3de_str label, std::uint32_t *index, const c3de_str *names,
                    std::uint64_t n) { return of(c).choice(textOf(id), textOf(label), index, names, n); };
  table.input_text = [](void *c, c3de_str id, c3de_str label, char *buffer, std::uint64_t capacity) {
    return of(c).textField("input", textOf(id), textOf(label), buffer, capacity);
  };
  table.progress = [](void *c, double fraction, c3de_str text) {
    std::string shown = "[";
    shown += fraction >= 0.0 ? formatNumber(std::round(fraction * 100.0)) + " %" : std::string("…");
    of(c).line(shown + "] " + textOf(text));
    of(c).widget("progress", {}, textOf(text), formatNumber(fraction));
  };
  table.value = [](void *c, c3de_str name, c3de_str value) {
    of(c).line(textOf(name) + ": " + textOf(value));
    of(c).widget("value", {}, textOf(name), textOf(value));
  };
  table.tooltip = [](void *c, c3de_str text) { of(c).output += "  | " + textOf(text); };
  table.params = [](void *c, c3de_handle set, c3de_str group) { of(c).params(Handle::fromBits(set.v), textOf(group)); };
  table.file_button = [](void *c, c3de_str id, c3de_str label, c3de_str, char *buffer, std::uint64_t capacity) {
    return of(c).textField("file", textOf(id), textOf(label), buffer, capacity);
  };
  table.swatch = [](void *c, float red, float green, float blue) {
    const auto byte = [](float v) { return static_cast<int>(std::lround(255.0f * std::clamp(v, 0.0f, 1.0f))); };
    const std::string text = fmt::format("#{:02x}{:02x}{:02x}", byte(red), byte(green), byte(blue));
    of(c).line("[" + text + "]");
    of(c).widget("swatch", {}, {}, text);
  };
  // Text does not scroll: lists have no frame in the output.
  table.list_begin = [](void *c, c3de_str id, std::uint32_t rows) {
    of(c).isSameLine = false;
    of(c).widget("list", textOf(id), {}, std::to_string(rows));
  };
  table.list_end = [](void *c) {
    of(c).isSameLine = false;
    of(c).widget("list end", {}, {}, {});
  };
  table.curve = [](void *c, c3de_str id, c3de_str label, c3de_str unit, const double *values, std::uint64_t n) {
    const std::string latest = values && n > 0 ? formatNumber(values[n - 1]) : std::string("no value");
    of(c).line(textOf(label) + ": curve of " + std::to_string(n) + ", " + latest + " " + textOf(unit) + " (" +
               textOf(id) + ")");
    of(c).widget("curve", textOf(id), textOf(label), latest);
  };
}

TextPanel::TextPanel(ParameterRegistry *parameters) : impl_(std::make_unique<Impl>()) {
  impl_->parameters = parameters;
  impl_->fillTable();
}
TextPanel::~TextPanel() = default;

std::string TextPanel::draw(const Panel &panel) {
  Impl &impl = *impl_;
  impl.widgets.clear();
  impl.problems.clear();
  impl.output.clear();
  impl.isSameLine = false;
  if (panel.onUi) panel.onUi(panel.self, &impl.table);
  for (const auto &[id, action] : impl.actions) impl.problems.push_back(id + ": there is no such widget");
  impl.actions.clear();
  return impl.output;
}

void TextPanel::press(const std::string &id) { impl_->actions[id] = {Action::Kind::press, false, 0.0, {}}; }
void TextPanel::check(const std::string &id, bool value) { impl_->actions[id] = {Action::Kind::check, value, 0.0, {}}; }
void TextPanel::setNumber(const std::string &id, double value) {
  impl_->actions[id] = {Action::Kind::number, false, value, {}};
}
void TextPanel::setText(const std::string &id, const std::string &text) {
  impl_->actions[id] = {Action::Kind::text, false, 0.0, text};
}

const std::vector<TextPanel::Widget> &TextPanel::widgets() const { return impl_->widgets; }

const TextPanel::Widget *TextPanel::find(const std::string &id) const {
  for (const Widget &widget : impl_->widgets)
    if (!id.empty() && widget.id == id) return &widget;
  return nullptr;
}

std::optional<std::string> TextPanel::value(const std::string &name) const {
  for (const Widget &widget : impl_->widgets)
    if (widget.kind == "value" && widget.label == name) return widget.text;
  return std::nullopt;
}

const std::vector<std::string> &TextPanel::problems() const { return impl_->problems; }

}  // namespace c3de::registry
