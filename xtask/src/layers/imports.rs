//! Paths in a source file that start in its own crate, wherever they occur: in imports,
//! expressions, types, attributes and the tokens of macros. Code compiled only for tests is
//! skipped.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use syn::punctuated::Punctuated;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, ImplItem, Item, Meta, Token, TraitItem, UseTree};

/// Path from the root of the crate, and the place that names it.
#[derive(Debug)]
pub(super) struct Import {
    /// Module in which the path is written; empty for the root of the crate.
    pub(super) module: Vec<String>,
    /// Named path, counted from the root. If it ends with `*`, it is a glob.
    pub(super) path: Vec<String>,
    /// Path as written.
    pub(super) written: String,
    /// The line, counted from one.
    pub(super) line: usize,
    /// Whether the path is only re-exported there.
    pub(super) reexported: bool,
}

/// `mod name;`, whose source is another file.
#[derive(Debug)]
pub(super) struct Child {
    /// Path of the module from the root of the crate.
    pub(super) module: Vec<String>,
    /// The line, counted from one.
    pub(super) line: usize,
    /// Whether a `path` attribute moves its file elsewhere.
    pub(super) moved: bool,
}

/// Paths and modules that [`Imports::of`] finds in one file.
#[derive(Debug, Default)]
pub(super) struct Imports {
    /// Module that is being read.
    module: Vec<String>,
    /// Paths, in the order of the file.
    pub(super) found: Vec<Import>,
    /// Modules that the file declares and that lie in other files.
    pub(super) children: Vec<Child>,
    /// Modules whose source is in this file, with their lines.
    pub(super) inline: Vec<Child>,
    /// Paths that do not start with `crate`, `self` or `super`, counted from the root as if their
    /// first name were in the module that writes them.
    pub(super) relative: Vec<Import>,
}

impl Imports {
    /// Reads `file`, the source of `module`.
    pub(super) fn of(file: &syn::File, module: &[String]) -> Self {
        let mut imports = Self { module: module.to_vec(), ..Self::default() };
        if !for_tests(&file.attrs) {
            imports.visit_file(file);
        }
        imports
    }

    fn record(&mut self, segments: &[String], line: usize) {
        self.record_import(segments, line, false);
    }

    fn record_import(&mut self, segments: &[String], line: usize, reexported: bool) {
        let import = |path| {
            let (module, written) = (self.module.clone(), segments.join("::"));
            Import { module, path, written, line, reexported }
        };
        match from_root(&self.module, segments) {
            Some(path) => self.found.push(import(path)),
            None => self.relative.push(import([&self.module[..], segments].concat())),
        }
    }

    /// Records the paths in tokens that are not parsed: those of macros and attributes.
    fn scan(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while at < tokens.len() {
            if let TokenTree::Group(group) = &tokens[at] {
                self.scan(group.stream());
            }
            at += self.scan_path(&tokens[at..]).max(1);
        }
    }

    /// Records the path that starts at the first of `tokens`, if one does. Returns its number of
    /// tokens.
    fn scan_path(&mut self, tokens: &[TokenTree]) -> usize {
        let Some(TokenTree::Ident(first)) = tokens.first() else { return 0 };
        let mut segments = vec![first.to_string()];
        let mut taken = 1;
        while let [TokenTree::Punct(a), TokenTree::Punct(b), next, ..] = &tokens[taken..] {
            match next {
                _ if a.as_char() != ':' || b.as_char() != ':' => break,
                TokenTree::Ident(ident) => segments.push(ident.to_string()),
                TokenTree::Punct(star) if star.as_char() == '*' => segments.push("*".to_owned()),
                TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => {
                    match syn::parse2::<UseTree>(TokenTree::Group(group.clone()).into()) {
                        Ok(tree) => leaves(&tree, &mut segments, &mut |path, _, span| {
                            self.record(path, span.start().line);
                        }),
                        // The group is a macro's pattern.
                        Err(_) => self.record(&segments, first.span().start().line),
                    }
                    return taken + 3;
                }
                _ => {
                    // `crate::$name` or a turbofish: the part known so far is checked.
                    self.record(&segments, first.span().start().line);
                    return taken + 2;
                }
            }
            taken += 3;
        }
        if taken > 1 || is_type(&segments[0]) {
            self.record(&segments, first.span().start().line);
        }
        taken
    }
}

impl<'ast> Visit<'ast> for Imports {
    fn visit_item(&mut self, item: &'ast Item) {
        if !for_tests(item_attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        let attributes = match item {
            ImplItem::Const(i) => &i.attrs,
            ImplItem::Fn(i) => &i.attrs,
            ImplItem::Type(i) => &i.attrs,
            ImplItem::Macro(i) => &i.attrs,
            _ => &Vec::new(),
        };
        if !for_tests(attributes) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_trait_item(&mut self, item: &'ast TraitItem) {
        let attributes = match item {
            TraitItem::Const(i) => &i.attrs,
            TraitItem::Fn(i) => &i.attrs,
            TraitItem::Type(i) => &i.attrs,
            TraitItem::Macro(i) => &i.attrs,
            _ => &Vec::new(),
        };
        if !for_tests(attributes) {
            visit::visit_trait_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        self.module.push(item.ident.to_string());
        let line = item.ident.span().start().line;
        let moved = item.attrs.iter().any(|a| a.path().is_ident("path"));
        let child = Child { module: self.module.clone(), line, moved };
        if item.content.is_some() {
            self.inline.push(child);
            visit::visit_item_mod(self, item);
        } else {
            self.children.push(child);
        }
        self.module.pop();
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if item.leading_colon.is_none() {
            let reexported = !matches!(item.vis, syn::Visibility::Inherited);
            leaves(&item.tree, &mut Vec::new(), &mut |path, _, span| {
                self.record_import(path, span.start().line, reexported);
            });
        }
    }

    fn visit_item_extern_crate(&mut self, item: &'ast syn::ItemExternCrate) {
        if item.ident == "self" {
            self.record(&["crate".to_owned()], item.ident.span().start().line);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let one_type = path.segments.len() == 1 && path.segments.iter().all(|s| is_type(&s.ident.to_string()));
        if path.leading_colon.is_none() && (path.segments.len() > 1 || one_type) {
            let segments: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
            self.record(&segments, path.span().start().line);
        }
        visit::visit_path(self, path);
    }

    fn visit_expr_call(&mut self, call: &'ast syn::ExprCall) {
        if let syn::Expr::Path(function) = &*call.func
            && let Some(name) = function.path.get_ident()
        {
            self.record(&[name.to_string()], name.span().start().line);
        }
        visit::visit_expr_call(self, call);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        self.visit_path(&call.path);
        self.scan(call.tokens.clone());
    }

    fn visit_meta_list(&mut self, list: &'ast syn::MetaList) {
        self.scan(list.tokens.clone());
    }

    // `pub(in crate::mesh)` imports nothing.
    fn visit_visibility(&mut self, _: &'ast syn::Visibility) {}
}

/// Calls `visit` with the full path, the name in scope and the place of each leaf of an import.
pub(super) fn leaves(
    tree: &UseTree,
    prefix: &mut Vec<String>,
    visit: &mut impl FnMut(&[String], &str, proc_macro2::Span),
) {
    let depth = prefix.len();
    match tree {
        UseTree::Path(path) => {
            prefix.push(path.ident.to_string());
            leaves(&path.tree, prefix, visit);
        }
        UseTree::Name(name) => {
            prefix.push(name.ident.to_string());
            visit(prefix, &name.ident.to_string(), name.ident.span());
        }
        UseTree::Rename(rename) => {
            prefix.push(rename.ident.to_string());
            visit(prefix, &rename.rename.to_string(), rename.ident.span());
        }
        UseTree::Glob(glob) => {
            prefix.push("*".to_owned());
            visit(prefix, "*", glob.span());
        }
        UseTree::Group(group) => group.items.iter().for_each(|tree| leaves(tree, prefix, visit)),
    }
    prefix.truncate(depth);
}

/// Reports whether a name is written like a type.
fn is_type(name: &str) -> bool {
    name.starts_with(char::is_uppercase)
}

/// Returns the path from the root that `segments` name in `module`, or `None` if they start in
/// another crate or scope.
pub(super) fn from_root(module: &[String], segments: &[String]) -> Option<Vec<String>> {
    let mut path = match segments.first()?.as_str() {
        "crate" => Vec::new(),
        "self" => module.to_vec(),
        "super" => module[..module.len().saturating_sub(1)].to_vec(),
        _ => return None,
    };
    for segment in &segments[1..] {
        match segment.as_str() {
            "self" => {}
            "super" => drop(path.pop()),
            name => path.push(name.to_owned()),
        }
    }
    Some(path)
}

/// Reports whether one of the attributes is a `cfg` that holds only in tests.
fn for_tests(attributes: &[Attribute]) -> bool {
    fn needs_test(condition: &Meta) -> bool {
        let parts = |list: &syn::MetaList| list.parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated);
        match condition {
            Meta::Path(path) => path.is_ident("test"),
            Meta::List(list) if list.path.is_ident("all") => parts(list).is_ok_and(|p| p.iter().any(needs_test)),
            Meta::List(list) if list.path.is_ident("any") => {
                parts(list).is_ok_and(|p| !p.is_empty() && p.iter().all(needs_test))
            }
            _ => false,
        }
    }
    attributes.iter().any(|a| a.path().is_ident("cfg") && a.parse_args::<Meta>().is_ok_and(|c| needs_test(&c)))
}

fn item_attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(i) => &i.attrs,
        Item::Enum(i) => &i.attrs,
        Item::ExternCrate(i) => &i.attrs,
        Item::Fn(i) => &i.attrs,
        Item::ForeignMod(i) => &i.attrs,
        Item::Impl(i) => &i.attrs,
        Item::Macro(i) => &i.attrs,
        Item::Mod(i) => &i.attrs,
        Item::Static(i) => &i.attrs,
        Item::Struct(i) => &i.attrs,
        Item::Trait(i) => &i.attrs,
        Item::TraitAlias(i) => &i.attrs,
        Item::Type(i) => &i.attrs,
        Item::Union(i) => &i.attrs,
        Item::Use(i) => &i.attrs,
        _ => &[],
    }
}
