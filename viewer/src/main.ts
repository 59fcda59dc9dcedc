/** Shows the data of the page, whose blocks tell what it is about. */
import "./style/base.css";
import "./style/frame.css";
import "./style/list.css";
import "./style/marks.css";
import "./style/view.css";
import "./style/details.css";
import "./style/help.css";
import "./style/steps.css";
import { startClashPage } from "./clash-page";
import { make } from "./elements";
import { startViewPage } from "./view-page";

const isReport = document.getElementById("report") !== null;

(isReport ? startClashPage() : startViewPage()).catch((error: unknown) => {
  const text = error instanceof Error ? error.message : String(error);
  document.body.prepend(make("p", { class: "failure", role: "alert" }, `The page cannot be shown: ${text}`));
  console.error(error);
});
