"""Generates the mutants of tools/mutate: splits a C++ file into tokens and lists all small changes.

A change is (kind, start, end, replacement) on the text of one file; KINDS names the kinds. A Mutant is the file with one change.
"""
import collections
import hashlib
import re

# ---- words of C++ --------------------------------------------------------------------------------

WORDS = re.compile(r"""
    (?P<skip>\s+|//[^\n]*|/\*.*?\*/|^[ \t]*\#(?:\\\n|[^\n])*)
  | (?P<string>(?:u8|[uUL])?"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])+')
  | (?P<number>\.?\d(?:'?[\w.]|(?<=[eEpP])[+-])*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<sign><=>|<<=|>>=|->\*|\.\.\.|::|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)
""", re.X | re.S | re.M)
Word = collections.namedtuple("Word", "kind text start end spaced")
OPENING, CLOSING = {"(": ")", "{": "}", "[": "]"}, {")": "(", "}": "{", "]": "["}
CONTROL = {"if", "for", "while", "switch"}
NO_STATEMENT = CONTROL | {"return", "else", "do", "case", "default", "using", "const", "constexpr", "static", "auto",
                          "static_assert", "break", "continue", "template", "friend", "namespace", "struct", "class"}


def words_of(text):
    """Tokens without comments, directives and blanks. `spaced`: blanks on both sides, as clang-format writes binary operators.
    Angle brackets of templates, references, pointers and signs never have them."""
    words = []
    for match in WORDS.finditer(text):
        if match.lastgroup == "skip":
            continue
        start, end = match.span()
        words.append(Word(match.lastgroup, match.group(), start, end, text[start - 1].isspace() and
                          text[end:end + 1].isspace()))
    return words


class Source:
    """One file as tokens, with its brackets and the kind of each brace."""

    def __init__(self, text):
        self.text, self.words = text, words_of(text)
        self.partner, self.around, self.kind = {}, [], {}
        self.returns = {}  # of a function's brace: the words of its return type, None for a lambda
        stack = []
        for i, word in enumerate(self.words):
            self.around.append(stack[-1] if stack else None)
            if word.kind != "sign":
                continue
            if word.text in OPENING:
                if word.text == "{":
                    self.kind[i] = self.kind_of_brace(i, stack)
                stack.append(i)
            elif word.text in CLOSING:
                opened = stack.pop()
                self.partner[opened], self.partner[i] = i, opened
                self.around[-1] = stack[-1] if stack else None

    def at(self, i):
        return self.words[i].text if 0 <= i < len(self.words) else ""

    def kind_of_brace(self, i, stack):
        j = i - 1
        if self.at(j) in ("else", "do"):
            return "control"
        while self.at(j) in ("noexcept", "const", "mutable", "override") or \
                (self.words[j].kind == "name" and self.at(j - 1) == "->"):
            j -= 2 if self.at(j - 1) == "->" else 1
        if self.at(j) == "]" and self.words[self.partner[j] - 1].kind != "name":
            self.returns[i] = None
            return "function"
        if self.at(j) == ")":
            opened = self.partner[j]
            if self.at(opened - 1) in CONTROL:
                return "control"
            if self.at(opened - 1) == "]":
                self.returns[i] = None
                return "function"
            if self.words[opened - 1].kind == "name" and not self.in_function(stack):
                first = opened - 1
                while first > 0 and self.at(first - 1) not in (";", "{", "}"):
                    first -= 1
                self.returns[i] = {word.text for word in self.words[first:opened - 1]}
                return "function"
        first = i
        while first > 0 and self.at(first - 1) not in (";", "{", "}"):
            first -= 1
        head = {word.text for word in self.words[first:i]}
        return "enum" if "enum" in head else "scope" if head & {"namespace", "struct", "class"} else "values"

    def in_function(self, stack):
        return any(self.kind.get(i) in ("function", "control") for i in stack)

    def brace(self, i):
        """The innermost brace around a token that opens a scope, not a list of values."""
        i = self.around[i]
        while i is not None and self.kind.get(i, "values") == "values":
            i = self.around[i]
        return i

    def function(self, i):
        while i is not None and self.kind.get(i) != "function":
            i = self.around[i]
        return i

    def end_of_statement(self, i):
        """Index of the semicolon of a statement, or None."""
        while i < len(self.words):
            text = self.at(i)
            if text == ";":
                return i
            if text in OPENING:
                i = self.partner.get(i, len(self.words))
            elif text in CLOSING:
                return None
            i += 1
        return None


# ---- the changes ---------------------------------------------------------------------------------

SWAPS = {"<": ["<=", ">="], "<=": ["<", ">"], ">": [">=", "<="], ">=": [">", "<"], "==": ["!="], "!=": ["=="],
         "&&": ["||"], "||": ["&&"], "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "+=": ["-="], "-=": ["+="],
         "|=": ["&="], "&=": ["|="], "<<": [">>"], ">>": ["<<"]}
KIND_OF_SWAP = {"&&": "and / or", "||": "and / or", "+": "arithmetic", "-": "arithmetic", "*": "arithmetic",
                "/": "arithmetic", "+=": "arithmetic", "-=": "arithmetic", "|=": "arithmetic", "&=": "arithmetic",
                "<<": "arithmetic", ">>": "arithmetic"}
COMPARISONS = {"<", "<=", ">", ">=", "==", "!="}
KINDS = ["comparison", "condition", "and / or", "not", "arithmetic", "constant", "bool", "min / max", "statement",
         "early return", "returned value"]


def is_comparison(word):
    return word.text in COMPARISONS and word.spaced


def condition_mutants(source, first, last):
    """Negates the tokens first..last, except a single comparison or `!`, which other changes negate."""
    inside = source.words[first:last + 1]
    joined = any(word.text in ("&&", "||") and word.spaced for word in inside)
    if joined or not (any(map(is_comparison, inside)) or inside[0].text == "!" or ";" in (w.text for w in inside)):
        start, end = inside[0].start, inside[-1].end
        yield "condition", start, end, "!(" + source.text[start:end] + ")"


def start_of_operand(source, i):
    """First token of the condition before a question mark."""
    while True:
        before = source.at(i - 1)
        if before in CLOSING:
            i = source.partner[i - 1]
        elif before in ("(", "{", "[", ",", ";", "=", "return", ":", "?", "+=", "") or before in ("|=", "}"):
            return i
        else:
            i -= 1


def statement_mutants(source, i):
    """Drops calls, assignments and steps."""
    word, before = source.words[i], source.at(i - 1)
    begins = before in (";", "{", "}", "else") or (before == ")" and source.at(source.partner[i - 1] - 1) in CONTROL) or \
        (before == ":" and source.at(i - 2) != "?" and not source.words[i - 1].spaced)
    home = source.brace(i)
    if not begins or home is None or source.kind[home] not in ("function", "control"):
        return
    if source.around[i] != home or word.text in NO_STATEMENT or not (word.kind == "name" or word.text in ("++", "--")):
        return
    end = source.end_of_statement(i)
    if end is None:
        return
    j = i + (word.text in ("++", "--"))
    while source.words[j].kind == "name" and source.at(j + 1) in ("::", ".", "->", "["):
        j = source.partner[j + 1] if source.at(j + 1) == "[" else j + 1
        j += 1
        if source.at(j) in (".", "->"):
            j += 1
        if source.at(j) in ("=", "+=", "-=", "|=", "("):
            break
    after = source.at(j + 1) if source.words[j].kind == "name" else source.at(j)
    is_call = after == "(" and source.at(end - 1) == ")"
    if is_call or after in ("=", "+=", "-=", "|=", "&=") or word.text in ("++", "--"):
        yield "statement", word.start, source.words[end - 1].end, ""


def return_mutants(source, i):
    end = source.end_of_statement(i)
    value = source.text[source.words[i].end:source.words[end].start].strip()
    function = source.function(source.brace(i))
    kinds = source.returns.get(function, set())
    inside = source.words[i + 1:end]
    looks_bool = value in ("true", "false") or any(is_comparison(w) or w.text in ("&&", "||", "!") for w in inside)
    looks_bool = looks_bool and "?" not in (w.text for w in inside)
    results = []
    if (kinds is None and looks_bool) or (kinds and "bool" in kinds):
        results = ["true", "false"]
    elif kinds and "optional" in kinds:
        results = ["std::nullopt"]
    for result in results:
        if value != result:
            yield "returned value", source.words[i].start, source.words[end].start, "return " + result
    before = source.at(i - 1)
    home = source.brace(i)
    if before in (")", "else") or (source.kind[home] == "control" and not (source.at(home - 1) == ")" and source.at(
            source.partner[home - 1] - 1) == "switch")) or value == "":
        yield "early return", source.words[i].start, source.words[end].start, ""


def mutants_of(text):
    """(kind, start, end, replacement) of every change to a file."""
    source = Source(text)
    words = source.words
    skip_until = -1
    for i, word in enumerate(words):
        if word.text == "static_assert":
            skip_until = source.end_of_statement(i)
        if i <= skip_until:
            continue
        before, after = source.at(i - 1), source.at(i + 1)
        if word.kind == "sign" and word.text in SWAPS and word.spaced:
            for other in SWAPS[word.text]:
                yield KIND_OF_SWAP.get(word.text, "comparison"), word.start, word.end, other
        elif word.text == "!":
            yield "not", word.start, word.end, ""
        elif word.text == "?":
            first = start_of_operand(source, i)
            yield from condition_mutants(source, first, i - 1)
        elif word.text in ("if", "while") and after == "(":
            yield from condition_mutants(source, i + 2, source.partner[i + 1] - 1)
        elif word.kind == "number":
            home = source.brace(i)
            in_template = (before == "<" and not words[i - 1].spaced) or (after == ">" and not words[i + 1].spaced)
            is_size = before == "[" and words[i - 2].kind == "name" and words[i - 3].kind == "name"
            # For integers x < 0 + 1 equals x <= 0, which is another change.
            is_bound = before in ("<", ">=") and words[i - 1].spaced and word.text.isdigit()
            if not in_template and not is_size and not is_bound and (home is None or source.kind[home] != "enum"):
                yield "constant", word.start, word.end, f"({word.text} + 1)"
        elif word.text in ("true", "false") and before != "return":
            yield "bool", word.start, word.end, "false" if word.text == "true" else "true"
        elif word.text in ("min", "max") and before == "::" and source.at(i - 2) == "std":
            yield "min / max", word.start, word.end, "max" if word.text == "min" else "min"
        elif word.text == "return":
            yield from return_mutants(source, i)
        elif word.text in ("break", "continue") and after == ";" and source.brace(i) is not None:
            yield "early return", word.start, word.end, ""
        yield from statement_mutants(source, i)


class Mutant:
    def __init__(self, file, text, kind, start, end, replacement):
        self.file, self.kind, self.start = file, kind, start
        dropped = text[start:end]
        if not replacement:  # keeps the line numbers
            replacement = "\n" * dropped.count("\n")
        self.text = text[:start] + replacement + text[end:]
        self.line = text.count("\n", 0, start) + 1
        first = text.rfind("\n", 0, start) + 1
        self.before = " ".join(text[first:text.find("\n", end)].split())
        last = start + len(replacement)
        self.after = " ".join(self.text[first:self.text.find("\n", last)].split())
        # A result stays valid while the definition around the change is unchanged.
        begin = max(text.rfind("\n}", 0, start), 0)
        block = text[begin:text.find("\n}", end)]
        self.key = digest(file, block, str(start - begin), str(end - begin), replacement.strip())


def digest(*texts):
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]
